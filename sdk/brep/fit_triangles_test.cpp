// SPDX-License-Identifier: Apache-2.0
#include "fit_triangles.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace meso::brep {
namespace {

/// Of a cylinder of radius 0.5 about z: the point at a turn and a height.
Vec3 on_cylinder(double turn, double height) { return {0.5 * std::cos(turn), 0.5 * std::sin(turn), height}; }

// The corners beside the short segment lie far off, and the strip bends between them: half-way towards them is beyond
// its border.
TEST(PartSegments, AShortSegmentAcrossAStripThatBendsTurnsNothingOver) {
  const Handle(Geom_Surface) cylinder = new Geom_CylindricalSurface(gp_Ax3(), 0.5);
  Triangulation strip;
  for (const auto& [turn, height] : {std::pair(0.905, 0.6562), {1.0507, 0.6105}, {1.189, 0.5562}, {1.0472, 0.61237}})
    strip.points.push_back({.point = on_cylinder(turn, height)});
  strip.triangles = {{0, 1, 3}, {1, 2, 3}};
  Triangulation other = strip;
  part_segments({{&strip, cylinder}, {&other, cylinder}}, {}, {{-9, -9, -9}, {9, 9, 9}}, 1e-9);
  ASSERT_EQ(strip.points.size(), 5u);
  EXPECT_EQ(strip.triangles.size(), 4u);
  for (const auto& t : strip.triangles) {
    const Vec3 a = strip.points[t[0]].point, b = strip.points[t[1]].point, c = strip.points[t[2]].point;
    const Vec3 middle = (a + b + c) / 3.0;
    EXPECT_GT(dot(cross(b - a, c - a), Vec3{middle.x, middle.y, 0}), 0);
  }
}

}  // namespace
}  // namespace meso::brep
