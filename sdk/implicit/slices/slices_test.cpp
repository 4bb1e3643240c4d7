// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/slices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<Slice> slices_of(const Field& field, const Grid& grid, const RunOptions& run = {}) {
  std::vector<Slice> out;
  DiagnosticSink sink;
  EXPECT_TRUE(slice(
      *compile(field.term(), grid), grid.nodes[2],
      [&](const Slice& s) {
        out.push_back(s);
        return true;
      },
      run, sink));
  return out;
}

/// By the even-odd rule: a ray along x.
bool filled(const Slice& slice, double x, double y) {
  bool inside = false;
  for (const auto& loop : slice.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto &p = loop[i], &q = loop[(i + 1) % loop.size()];
      if ((p[1] > y) == (q[1] > y)) continue;
      if (x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])) inside = !inside;
    }
  return inside;
}

TEST(Slices, OfABallAreCircles) {
  const Grid grid{.box = {{-1.1, -1.1, -0.8}, {1.1, 1.1, 0.8}}, .nodes = {120, 120, 17}};
  const auto slices = slices_of(Field::ball(1), grid);
  ASSERT_EQ(slices.size(), 17u);
  for (const Slice& s : slices) {
    ASSERT_EQ(s.loops.size(), 1u);
    const double r2 = 1 - s.height * s.height;
    EXPECT_NEAR(s.area(), pi * r2, 2e-3);
    for (const auto& p : s.loops[0]) EXPECT_NEAR(p[0] * p[0] + p[1] * p[1], r2, 5e-4);
  }
  EXPECT_EQ(slices.front().height, -0.8);
  EXPECT_EQ(slices.back().height, 0.8);
}

TEST(Slices, HolesGoTheOtherWayRound) {
  const Grid grid{.box = {{-1.2, -1.2, 0}, {1.2, 1.2, 0.1}}, .nodes = {200, 200, 2}};
  const Slice s = slices_of(difference_of(Field::cylinder(1), Field::cylinder(0.5)), grid)[0];
  ASSERT_EQ(s.loops.size(), 2u);
  EXPECT_NEAR(s.area(), pi * 0.75, 2e-3);
  EXPECT_GT(Slice{.loops = {s.loops[0]}}.area() * -Slice{.loops = {s.loops[1]}}.area(), 0);
  EXPECT_TRUE(filled(s, 0.7, 0.01));
  EXPECT_FALSE(filled(s, 0.01, 0.02));
}

TEST(Slices, CloseAlongTheBoxesBorder) {
  const Grid grid{.box = {{-1, -2, 0}, {3, 5, 1}}, .nodes = {7, 9, 2}};
  const Slice s = slices_of(Field::ball(100), grid)[0];
  ASSERT_EQ(s.loops.size(), 1u);
  EXPECT_NEAR(s.area(), 28, 1e-12);
}

TEST(Slices, AgreeWithTheFieldAwayFromContours) {
  DiagnosticSink sink;
  const Field gyroid = *Field::surface("gyroid", sink);
  const Grid grid{.box = {{0, 0, 0.1}, {2, 2, 0.9}}, .nodes = {161, 161, 5}};
  for (const Slice& s : slices_of(gyroid, grid)) {
    std::size_t asked = 0;
    for (int a = 0; a < 40; ++a)
      for (int b = 0; b < 40; ++b) {
        const double x = 0.017 + a * 0.0491, y = 0.023 + b * 0.0487, v = gyroid.value({x, y, s.height});
        if (std::abs(v) < 0.05) continue;
        ++asked;
        ASSERT_EQ(filled(s, x, y), v < 0) << x << ' ' << y << ' ' << s.height;
      }
    EXPECT_GT(asked, 1000u);
  }
}

TEST(Slices, SaddlesAndNoiseGiveClosedContoursThatFillWhatIsInside) {
  DiagnosticSink sink;
  const Field noise = *Field::expression("sin(50*x)*sin(53*y)+0.2*sin(31*x-47*y)+0.01*z", sink);
  const Grid grid{.box = {{0, 0, 0}, {1, 1, 1}}, .nodes = {40, 37, 2}};
  for (const Slice& s : slices_of(noise, grid)) {
    EXPECT_GT(s.loops.size(), 15u);
    for (std::int32_t j = 1; j < 36; ++j)
      for (std::int32_t i = 1; i < 39; ++i) {
        const Vec3 p = grid.node(i, j, s.height > 0 ? 1 : 0);
        // A ray through nodes would meet vertices: a little beside, where the node still decides.
        ASSERT_EQ(filled(s, p.x + 1e-7, p.y + 1e-7), noise.value(p) < 0) << i << ' ' << j;
      }
  }
}

TEST(Slices, EqualForAnyNumberOfThreadsAndStoppedWhenAsked) {
  DiagnosticSink sink;
  const Field gyroid = *Field::surface("gyroid", sink);
  const Grid grid{.box = {{0, 0, 0}, {1, 1, 1}}, .nodes = {30, 30, 20}};
  const auto one = slices_of(gyroid, grid, {.jobs = 1}), three = slices_of(gyroid, grid, {.jobs = 3});
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].loops, three[i].loops);
  EXPECT_FALSE(slice(
      *compile(gyroid.term(), grid), 20, [](const Slice&) { return true; }, {.cancelled = [] { return true; }}, sink));
  EXPECT_FALSE(slice(
      *compile(gyroid.term(), grid), 20, [](const Slice&) { return true; }, {.max_memory_bytes = 100}, sink));
  ASSERT_EQ(sink.error_count(), 2u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::cancelled);
  EXPECT_EQ(sink.diagnostics()[1].code, Code::limit_grid_memory);
}

}  // namespace
}  // namespace meso::implicit
