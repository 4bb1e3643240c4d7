// SPDX-License-Identifier: Apache-2.0
#include "meso/export_svg/write_plot_svg.hpp"

#include <gtest/gtest.h>

#include <regex>

namespace meso {
namespace {

PlotSpec bytes_over_cells() {
  PlotSpec plot{
      .title = "Bytes over cells", .x_label = "cells", .y_label = "bytes", .x_log = true, .y_log = true, .series = {}};
  plot.series.push_back({"STEP", {{10, 100}, {100, 1000}, {1000, 10000}}});
  plot.series.push_back({"document", {{10, 100}, {100, 100}, {1000, 100}}});
  return plot;
}

/// The points of the curves, in order of appearance.
std::vector<std::string> curves(const std::string& svg) {
  std::vector<std::string> found;
  const std::regex pattern("d=\"([^\"]*)\" fill=\"none\"");
  for (std::sregex_iterator i(svg.begin(), svg.end(), pattern), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

TEST(PlotSvg, APowerLawIsAStraightDiagonal) {
  const auto found = curves(write_plot_svg(bytes_over_cells()));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], "M72.0 456.0L424.0 280.0L776.0 104.0");
  EXPECT_EQ(found[1], "M72.0 456.0L424.0 456.0L776.0 456.0");
}

TEST(PlotSvg, NamesAreEscaped) {
  PlotSpec plot = bytes_over_cells();
  plot.title = "a<b & \"c\"";
  const std::string svg = write_plot_svg(plot);
  EXPECT_NE(svg.find("<title>a&lt;b &amp; \"c\"</title>"), std::string::npos);
  EXPECT_EQ(svg.find("a<b"), std::string::npos);
}

TEST(PlotSvg, StandsAlone) {
  const std::string svg = write_plot_svg(bytes_over_cells());
  EXPECT_EQ(svg.find("href"), std::string::npos);
  EXPECT_EQ(svg.find("url("), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg, write_plot_svg(bytes_over_cells()));
}

TEST(PlotSvg, NoPointsIsAnEmptyFrame) {
  const std::string svg = write_plot_svg({.title = "", .x_label = "", .y_label = "", .series = {{"nothing", {}}}});
  EXPECT_TRUE(curves(svg).empty());
  EXPECT_NE(svg.find(">10</text>"), std::string::npos);
}

}  // namespace
}  // namespace meso
