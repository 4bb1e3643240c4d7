// SPDX-License-Identifier: Apache-2.0
#include "plane_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace meso::brep {
namespace {

struct Region {
  std::vector<PlanePoint> points;
  std::vector<std::vector<std::uint32_t>> loops;

  void add(const std::vector<PlanePoint>& polygon) {
    loops.emplace_back();
    for (const PlanePoint& p : polygon) {
      loops.back().push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(p);
    }
  }
  void add_circle(double x, double y, double radius, int sides) {
    std::vector<PlanePoint> polygon;
    for (int i = 0; i < sides; ++i) {
      const double a = 2 * std::numbers::pi * i / sides;
      polygon.push_back({x + radius * std::cos(a), y - radius * std::sin(a)});
    }
    add(polygon);
  }
};

double area_of(const Region& region, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const PlanePoint &p = region.points[a], &q = region.points[b], &r = region.points[c];
    const double area = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 2;
    EXPECT_GE(area, -1e-9);
    sum += area;
  }
  return sum;
}

/// Sides that only one triangle has, as directed pairs, are those of the loops.
void expect_bounded_by_loops(const Region& region, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      ++uses[{a, b}];
    }
  std::size_t sides = 0;
  for (const auto& loop : region.loops)
    for (std::size_t i = 0; i < loop.size(); ++i, ++sides) {
      const auto [a, b] = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
      EXPECT_EQ((uses[{a, b}]), 1);
    }
  std::size_t single = 0;
  for (const auto& [side, count] : uses) {
    EXPECT_LE(count, 2);
    single += count == 1;
  }
  EXPECT_EQ(single, sides);
}

double polygon_area(double radius, int sides) {
  return sides * radius * radius * std::sin(2 * std::numbers::pi / sides) / 2;
}

TEST(PlaneMesh, PlateWithAGridOfHoles) {
  Region region;
  region.add({{0, 0}, {40, 0}, {40, 30}, {0, 30}});
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 30; ++j) region.add_circle(i + 0.5, j + 0.5, 0.4, 24);
  const auto triangles = triangulate_between(region.points, region.loops);
  ASSERT_TRUE(triangles);
  EXPECT_NEAR(area_of(region, *triangles), 1200 - 1200 * polygon_area(0.4, 24), 1e-8);
  expect_bounded_by_loops(region, *triangles);
  // Euler: a region with h holes and n points has n + 2 h - 2 triangles.
  EXPECT_EQ(triangles->size(), region.points.size() + 2 * 1200 - 2);
}

TEST(PlaneMesh, LongSidesAreForcedThroughOtherPoints) {
  // A comb: its back passes close below a thousand points that would rather have each other for neighbours.
  Region region;
  std::vector<PlanePoint> comb{{0, 0}, {1000, 0}, {1000, 1}};
  for (int i = 999; i >= 0; --i) {
    comb.push_back({i + 0.9, 1});
    comb.push_back({i + 0.9, 200.0 + i % 7});
    comb.push_back({i + 0.5, 200.0 + i % 5});
    comb.push_back({i + 0.5, 1});
  }
  comb.push_back({0, 1});
  region.add(comb);
  const auto triangles = triangulate_between(region.points, region.loops);
  ASSERT_TRUE(triangles);
  double twice = 0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const PlanePoint &a = comb[i], &b = comb[(i + 1) % comb.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  EXPECT_NEAR(area_of(region, *triangles), twice / 2, 1e-6);
  expect_bounded_by_loops(region, *triangles);
}

TEST(PlaneMesh, RandomStars) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.05, 1);
  for (int round = 0; round < 200; ++round) {
    Region region;
    std::vector<PlanePoint> star;
    double area = 0;
    const int n = 5 + round % 40;
    for (int i = 0; i < n; ++i) {
      const double r = radius(random), a = 2 * std::numbers::pi * i / n;
      star.push_back({7 + r * std::cos(a), -3 + r * std::sin(a)});
    }
    for (int i = 0; i < n; ++i) {
      const PlanePoint p = star[static_cast<std::size_t>(i)], q = star[static_cast<std::size_t>((i + 1) % n)];
      area += ((p[0] - 7) * (q[1] + 3) - (p[1] + 3) * (q[0] - 7)) / 2;
    }
    region.add(star);
    const auto triangles = triangulate_between(region.points, region.loops);
    ASSERT_TRUE(triangles) << round;
    EXPECT_NEAR(area_of(region, *triangles), area, 1e-9) << round;
    expect_bounded_by_loops(region, *triangles);
  }
}

TEST(PlaneMesh, AHoleInAHoleIsFull) {
  Region region;
  for (const double half : {5.0, 3.0, 1.0}) region.add({{-half, -half}, {half, -half}, {half, half}, {-half, half}});
  const auto triangles = triangulate_between(region.points, region.loops);
  ASSERT_TRUE(triangles);
  EXPECT_DOUBLE_EQ(area_of(region, *triangles), 100 - 36 + 4);
}

TEST(PlaneMesh, LoopsThatCrossAreRefused) {
  Region region;
  region.add({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  region.add({{-1, 4}, {5, 4}, {5, 6}, {-1, 6}});
  EXPECT_FALSE(triangulate_between(region.points, region.loops));
  Region touching;  // a corner in the middle of a side
  touching.add({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  touching.add({{0, 4}, {5, 4}, {5, 6}});
  EXPECT_FALSE(triangulate_between(touching.points, touching.loops));
}

}  // namespace
}  // namespace meso::brep
