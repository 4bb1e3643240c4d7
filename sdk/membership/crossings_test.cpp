// SPDX-License-Identifier: Apache-2.0
#include "meso/membership/crossings.hpp"

#include <gtest/gtest.h>

#include <random>

namespace meso::membership {
namespace {

/// An octahedron whose sides are quartered `levels` times, pushed out to a sphere if `is_round`.
TriangleMesh octahedron(int levels, bool is_round, Vec3 centre = {}) {
  std::vector<Triangle> triangles;
  for (int n = 0; n < 8; ++n) {
    const Vec3 a{n & 1 ? 1.0 : -1.0, 0, 0}, b{0, n & 2 ? 1.0 : -1.0, 0}, c{0, 0, n & 4 ? 1.0 : -1.0};
    triangles.push_back(dot(a, cross(b, c)) > 0 ? Triangle{a, b, c} : Triangle{a, c, b});
  }
  for (; levels > 0; --levels) {
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
      for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) finer.push_back(t);
    }
    triangles = finer;
  }
  TriangleMesh mesh;
  for (const Triangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (const Vec3 p : t) mesh.points.push_back(centre + (is_round ? p / norm(p) : p));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<Vec3> random_points(int count, double reach) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

TEST(Crossings, OfAnOctahedronAreExact) {
  const TriangleMesh mesh = octahedron(3, false);
  const TriangleSolid solid(mesh);
  const auto points = random_points(20000, 1.2);
  const auto inside = inside_of(triangles_of(mesh), points, {});
  int wrong = 0, found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i];
    const bool expected = std::abs(p.x) + std::abs(p.y) + std::abs(p.z) < 1;
    wrong += inside[i] != expected;
    wrong += solid.contains(p) != expected;
    found += expected;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(found, 1000);
}

TEST(Crossings, PointsBelowCornersAndEdgesAreNoExceptions) {
  const TriangleMesh mesh = octahedron(2, false);
  std::vector<Vec3> points;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j)
      for (int k = -4; k <= 4; ++k)
        if (std::abs(i) + std::abs(j) + std::abs(k) != 4) points.push_back({i / 4.0, j / 4.0, k / 4.0});
  const auto inside = inside_of(triangles_of(mesh), points, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i];
    EXPECT_EQ(inside[i], std::abs(p.x) + std::abs(p.y) + std::abs(p.z) < 1) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(Crossings, VoidsAreOutside) {
  TriangleMesh mesh = octahedron(4, true);
  const TriangleMesh hollow = octahedron(2, false);
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (const Vec3 p : hollow.points) mesh.points.push_back(0.5 * p);
  for (const auto& t : hollow.triangles) mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  const TriangleSolid solid(mesh);
  EXPECT_FALSE(solid.contains({0.1, 0.1, 0.1}));
  EXPECT_TRUE(solid.contains({0.5, 0.2, 0.3}));
  EXPECT_FALSE(solid.contains({0.9, 0.9, 0.9}));
  EXPECT_FALSE(solid.contains({3, 0, 0}));
}

TEST(Crossings, NoPointsOrNoTriangles) {
  EXPECT_TRUE(inside_of(triangles_of(TriangleMesh{}), {}, {}).empty());
  const std::vector<Vec3> one{{0, 0, 0}};
  EXPECT_EQ(inside_of([](const TriangleBlockCallback&) {}, one, {}), std::vector<bool>{false});
  EXPECT_FALSE(TriangleSolid(TriangleMesh{}).contains({0, 0, 0}));
}

}  // namespace
}  // namespace meso::membership
