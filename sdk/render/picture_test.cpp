// SPDX-License-Identifier: Apache-2.0
#include "meso/render/picture.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include "shapes_for_test.hpp"

namespace meso::picture {
namespace {

constexpr RenderOptions small{.width = 160, .height = 120};

/// The paper's colour depends on the row alone, and the first column is always paper.
bool is_paper(const Image& image, std::uint32_t x, std::uint32_t y) {
  const auto* row = image.rgb.data() + std::size_t{3} * image.width * y;
  return std::equal(row, row + 3, row + std::size_t{3} * x);
}

int brightness(const Image& image, double x, double y) {
  const auto column = static_cast<std::uint32_t>(x * image.width), row = static_cast<std::uint32_t>(y * image.height);
  const auto* p = image.rgb.data() + std::size_t{3} * (std::size_t{row} * image.width + column);
  return p[0] + p[1] + p[2];
}

TEST(Draw, ASphereCoversItsDisk) {
  DiagnosticSink sink;
  const auto image = draw(sphere_soup(25, 90), {.width = 400, .height = 300}, {}, sink);
  ASSERT_TRUE(image);
  int covered = 0;
  for (std::uint32_t y = 0; y < image->height; ++y)
    for (std::uint32_t x = 0; x < image->width; ++x) covered += !is_paper(*image, x, y);
  const double radius = 0.94 * 150;  // pixels: the fit leaves 6 % of the half picture on each side
  EXPECT_NEAR(covered, std::numbers::pi * radius * radius, 0.015 * covered);
}

/// Share of a sphere's disk that a section through its centre covers, by colour: the section is warm, all else is cool.
double section_share(const TriangleMesh& mesh) {
  DiagnosticSink sink;
  const RenderOptions options{.width = 400, .height = 300, .up = Up::z, .cut = Cut{.axis = 2, .position = 0}};
  const auto image = draw(mesh, options, {}, sink);
  if (!image) return -1;
  int warm = 0;
  for (std::size_t i = 0; i < image->rgb.size(); i += 3) warm += image->rgb[i] > image->rgb[i + 2] + 20;
  const double radius = 0.94 * 150;
  return warm / (std::numbers::pi * radius * radius);
}

TEST(Draw, ACutThroughTheCentreShowsTheSectionForeshortened) {
  EXPECT_NEAR(section_share(sphere_soup(25, 90)), std::sin(RenderOptions{}.elevation), 0.06);
}

TEST(Draw, ACutShowsHollowsAsHollows) {
  TriangleMesh shell = sphere_soup(25, 60);
  TriangleMesh hollow = sphere_soup(12.5, 60);
  const auto first = static_cast<std::uint32_t>(shell.points.size());
  shell.points.insert(shell.points.end(), hollow.points.begin(), hollow.points.end());
  for (const auto& t : hollow.triangles) shell.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  EXPECT_NEAR(section_share(shell), 0.75 * section_share(sphere_soup(25, 60)), 0.02);
}

TEST(Draw, TheLampShinesOnTopAndFromTheLeft) {
  DiagnosticSink sink;
  RenderOptions options = small;
  options.azimuth = std::numbers::pi / 4;
  const auto image = draw(box_soup({0, 0, 0}, {10, 10, 10}), options, {}, sink);
  ASSERT_TRUE(image);
  const int top = brightness(*image, 0.5, 0.25);
  const int left = brightness(*image, 0.4, 0.6), right = brightness(*image, 0.6, 0.6);
  EXPECT_GT(top, left + 30);
  EXPECT_GT(left, right + 30);
}

TEST(Draw, BytesDoNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = sphere_soup(3, 20);
  DiagnosticSink sink;
  const auto one = draw(mesh, small, {.jobs = 1}, sink);
  ASSERT_TRUE(one);
  for (const unsigned jobs : {2U, 3U, 0U}) {
    const auto several = draw(mesh, small, {.jobs = jobs}, sink);
    ASSERT_TRUE(several);
    EXPECT_EQ(several->rgb, one->rgb) << jobs << " jobs";
  }
}

TEST(Draw, NothingToDrawIsSaid) {
  DiagnosticSink sink;
  TriangleMesh line;
  add_triangle(line, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_FALSE(draw(line, small, {}, sink));
  EXPECT_FALSE(draw(TriangleMesh{}, small, {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 2U);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::render_nothing);
  EXPECT_EQ(sink.diagnostics()[1].code, Code::render_nothing);
}

TEST(Draw, StopsWhenAsked) {
  DiagnosticSink sink;
  int polls = 0;
  RunOptions run;
  run.cancelled = [&] { return ++polls > 2; };
  EXPECT_FALSE(draw(box_soup({0, 0, 0}, {1, 1, 1}), small, run, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::cancelled);
}

TEST(Png, ReadsBackAsTheSamePixels) {
  DiagnosticSink sink;
  const auto image = draw(box_soup({0, 0, 0}, {1, 2, 3}), {.width = 33, .height = 20}, {}, sink);
  ASSERT_TRUE(image);
  const std::string bytes = png(*image);
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes.find("tIME"), std::string::npos);
  EXPECT_EQ(bytes.find("tEXt"), std::string::npos);

  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&control, bytes.data(), bytes.size()));
  control.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(control));
  ASSERT_TRUE(png_image_finish_read(&control, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(control.width, 33U);
  EXPECT_EQ(control.height, 20U);
  EXPECT_EQ(pixels, image->rgb);
}

}  // namespace
}  // namespace meso::picture
