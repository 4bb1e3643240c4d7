// SPDX-License-Identifier: Apache-2.0
#include "camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "shapes_for_test.hpp"

namespace meso::picture {
namespace {

Box3 box(Vec3 size) {
  Box3 b;
  b.extend({0, 0, 0});
  b.extend(size);
  return b;
}

TEST(View, TallPartsLieDownAndOthersStand) {
  EXPECT_EQ(view_for({}, box({50, 60, 200})).vertical, (Vec3{0, 1, 0}));
  EXPECT_EQ(view_for({}, box({50, 60, 70})).vertical, (Vec3{0, 0, 1}));
  EXPECT_EQ(view_for({.up = Up::z}, box({50, 60, 200})).vertical, (Vec3{0, 0, 1}));
}

TEST(View, IsARightHandedFrameThatKeepsUpUpright) {
  for (const Up up : {Up::x, Up::y, Up::z}) {
    const View view = view_for({.up = up, .azimuth = 2.1, .elevation = -0.3}, box({1, 1, 1}));
    EXPECT_NEAR(norm(cross(view.right, view.up) - view.back), 0, 1e-14);
    EXPECT_NEAR(dot(view.right, view.vertical), 0, 1e-14);
    EXPECT_NEAR(dot(view.back, view.vertical), std::sin(-0.3), 1e-14);
  }
}

TEST(Camera, FitsTightlyAndInTheMiddle) {
  const std::vector<Vec3> points = box_soup({-3, 10, 0}, {40, 15, 22}).points;
  const View view = view_for({}, box({1, 1, 1}));
  for (const auto& [width, height] : {std::pair{1200U, 900U}, {300U, 900U}, {64U, 64U}}) {
    const Camera camera(view, points, width, height);
    // Where a point appears, from the rays alone: the ray plane's coordinates are linear in the pixel's.
    const Vec3 middle = camera.ray(width / 2.0, height / 2.0), corner = camera.ray(width, 0);
    const double tan_x = dot(corner, view.right) / dot(corner, middle);
    const double tan_y = dot(corner, view.up) / dot(corner, middle);
    double left = 1, right = -1, bottom = 1, top = -1;
    for (const Vec3& p : points) {
      const Vec3 d = p - camera.position();
      const double x = dot(d, view.right) / dot(d, middle) / tan_x, y = dot(d, view.up) / dot(d, middle) / tan_y;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
    EXPECT_NEAR(std::max({-left, right, -bottom, top}), 0.94, 1e-9);
    EXPECT_NEAR(left + right, 0, 0.05);
    EXPECT_NEAR(bottom + top, 0, 0.05);
  }
}

}  // namespace
}  // namespace meso::picture
