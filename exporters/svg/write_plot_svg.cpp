// SPDX-License-Identifier: Apache-2.0
#include "meso/export_svg/write_plot_svg.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <string_view>

#include "axis.hpp"
#include "meso/base/xml_text.hpp"

namespace meso {
namespace {

// Pixels. The frame of the curves leaves room for the title and legend above, ticks and names beside and below.
constexpr double width = 800, height = 520;
constexpr double left = 72, right = 776, top = 104, bottom = 456;

// Dark enough for thin lines on white, and apart for the colour-blind (after Okabe and Ito).
constexpr std::array<std::string_view, 5> colors{"#2b6ca3", "#c8561e", "#2f8f68", "#8456a5", "#a8780a"};

std::string number(double value) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 1).ptr;
  return {text.data(), end};
}

std::string text_at(double x, double y, std::string_view attributes, std::string_view text) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\"" + std::string(attributes) + ">" + escaped_text(text) +
         "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, std::string_view stroke) {
  return "<path d=\"M" + number(x1) + " " + number(y1) + "L" + number(x2) + " " + number(y2) + "\" stroke=\"" +
         std::string(stroke) + "\"/>\n";
}

/// Circle, square, triangle, diamond, hanging triangle: the series stay apart in a grey print.
std::string marker(double x, double y, std::size_t kind) {
  const auto point = [&](double dx, double dy) { return number(x + dx) + " " + number(y + dy); };
  std::string path;
  switch (kind % colors.size()) {
    case 0:
      return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"4\"/>";
    case 1:
      path = point(-3.6, -3.6) + "L" + point(3.6, -3.6) + "L" + point(3.6, 3.6) + "L" + point(-3.6, 3.6);
      break;
    case 2:
      path = point(0, -4.8) + "L" + point(4.5, 3.4) + "L" + point(-4.5, 3.4);
      break;
    case 3:
      path = point(0, -5) + "L" + point(5, 0) + "L" + point(0, 5) + "L" + point(-5, 0);
      break;
    default:
      path = point(0, 4.8) + "L" + point(4.5, -3.4) + "L" + point(-4.5, -3.4);
  }
  return "<path d=\"M" + path + "Z\"/>";
}

struct Frame {
  Axis x, y;
  [[nodiscard]] double at_x(double value) const { return left + x.fraction(value) * (right - left); }
  [[nodiscard]] double at_y(double value) const { return bottom - y.fraction(value) * (bottom - top); }
};

template <double PlotSeries::Point::*Coordinate>
Axis axis_over(const std::vector<PlotSeries>& series, bool log) {
  double min = HUGE_VAL, max = -HUGE_VAL;
  for (const PlotSeries& s : series)
    for (const PlotSeries::Point& p : s.points) {
      assert(std::isfinite(p.*Coordinate) && (!log || p.*Coordinate > 0));
      min = std::min(min, p.*Coordinate);
      max = std::max(max, p.*Coordinate);
    }
  return min <= max ? axis_for(min, max, log) : axis_for(1, 10, log);
}

std::string grid(const Frame& frame) {
  std::string out = "<g stroke-width=\"1\" fill=\"#4a5157\">\n";
  for (const Tick& tick : frame.x.ticks) {
    const double x = frame.at_x(tick.value);
    out += line(x, top, x, bottom, tick.label.empty() ? "#f1f3f5" : "#dde1e5");
    if (!tick.label.empty()) out += text_at(x, bottom + 20, " text-anchor=\"middle\"", tick.label);
  }
  for (const Tick& tick : frame.y.ticks) {
    const double y = frame.at_y(tick.value);
    out += line(left, y, right, y, tick.label.empty() ? "#f1f3f5" : "#dde1e5");
    if (!tick.label.empty()) out += text_at(left - 10, y + 4, " text-anchor=\"end\"", tick.label);
  }
  return out + line(left, bottom, right, bottom, "#6b737a") + line(left, top, left, bottom, "#6b737a") + "</g>\n";
}

std::string curve(const PlotSeries& series, const Frame& frame, std::size_t index) {
  const std::string color(colors[index % colors.size()]);
  std::string path, markers;
  for (const PlotSeries::Point& p : series.points) {
    const double x = frame.at_x(p.x), y = frame.at_y(p.y);
    path += (path.empty() ? "M" : "L") + number(x) + " " + number(y);
    markers += marker(x, y, index) + "\n";
  }
  if (path.empty()) return {};
  return "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + color +
         "\" stroke-width=\"2\" stroke-linejoin=\"round\"/>\n<g fill=\"" + color +
         "\" stroke=\"#ffffff\" stroke-width=\"1\">\n" + markers + "</g>\n";
}

std::string legend_entry(double x, const std::string& name, std::size_t index) {
  const std::string color(colors[index % colors.size()]);
  return "<g fill=\"" + color + "\"><path d=\"M" + number(x) + " 58H" + number(x + 26) + "\" stroke=\"" + color +
         "\" stroke-width=\"2\"/>" + marker(x + 13, 58, index) + "</g>\n" +
         text_at(x + 33, 62, " fill=\"#23282d\"", name);
}

std::string legend(const std::vector<PlotSeries>& series) {
  std::string out;
  double x = left;
  for (std::size_t i = 0; i < series.size(); ++i) {
    out += legend_entry(x, series[i].name, i);
    // The text's width is not known without its font; 7.5 pixels a letter is generous at this size.
    x += 33 + 7.5 * static_cast<double>(series[i].name.size()) + 22;
  }
  return out;
}

}  // namespace

std::string write_plot_svg(const PlotSpec& plot) {
  const Frame frame{axis_over<&PlotSeries::Point::x>(plot.series, plot.x_log),
                    axis_over<&PlotSeries::Point::y>(plot.series, plot.y_log)};
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " + number(height) +
                    "\" width=\"" + number(width) + "\" height=\"" + number(height) +
                    "\" role=\"img\" font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\" "
                    "font-size=\"13\">\n<title>" +
                    escaped_text(plot.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  out += text_at(left, 32, " font-size=\"18\" font-weight=\"600\" fill=\"#15191d\"", plot.title);
  out += legend(plot.series);
  out += text_at(16, top - 14, " fill=\"#4a5157\"", plot.y_label);
  out += text_at((left + right) / 2, bottom + 46, " text-anchor=\"middle\" fill=\"#4a5157\"", plot.x_label);
  out += grid(frame);
  for (std::size_t i = 0; i < plot.series.size(); ++i) out += curve(plot.series[i], frame, i);
  return out + "</svg>\n";
}

}  // namespace meso
