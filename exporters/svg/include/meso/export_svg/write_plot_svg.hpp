// SPDX-License-Identifier: Apache-2.0
#pragma once
// A line plot as one self-contained SVG text: no fonts, scripts or style sheets from elsewhere.
//
//   PlotSpec plot{.title = "Bytes over cells", .x_label = "cells", .y_label = "bytes", .x_log = true, .y_log = true};
//   plot.series.push_back({"STEP", {{280, 3.4e6}, {2240, 2.7e7}}});
//   file << write_plot_svg(plot);
//
// Points are drawn in the order given. All values must be finite, and above zero along a logarithmic axis (checked by
// assert). Linear axes of positive values begin at zero. Equal plots give equal bytes. Cost: linear in the points.

#include <string>
#include <vector>

namespace meso {

struct PlotSeries {
  struct Point {
    double x, y;
  };
  std::string name;
  std::vector<Point> points;
};

struct PlotSpec {
  std::string title, x_label, y_label;
  bool x_log = false, y_log = false;
  std::vector<PlotSeries> series;  ///< five colours and markers, repeated after that
};

[[nodiscard]] std::string write_plot_svg(const PlotSpec& plot);

}  // namespace meso
