// SPDX-License-Identifier: Apache-2.0
#include "half_edge_sum.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace meso::operations {
namespace {

std::vector<Triangle> tetrahedron() {
  const Vec3 o{0.1, 0.2, 0.3}, a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  return {{o, b, a}, {o, c, b}, {o, a, c}, {a, b, c}};
}

std::pair<bool, std::uint64_t> judged(const std::vector<Triangle>& triangles) {
  HalfEdgeSum sum;
  for (const Triangle& t : triangles) sum.add(t);
  return {sum.is_balanced(),
          count_unmatched_half_edges([&](const TriangleBlockCallback& callback) { callback(triangles); })};
}

TEST(HalfEdgeSum, AClosedSurfaceLeavesNothing) { EXPECT_EQ(judged(tetrahedron()), std::pair(true, std::uint64_t{0})); }

TEST(HalfEdgeSum, AHole) {
  auto triangles = tetrahedron();
  triangles.pop_back();
  EXPECT_EQ(judged(triangles), std::pair(false, std::uint64_t{3}));
}

TEST(HalfEdgeSum, ATurnedTriangle) {
  auto triangles = tetrahedron();
  std::swap(triangles[2][0], triangles[2][1]);
  EXPECT_EQ(judged(triangles), std::pair(false, std::uint64_t{6}));
}

TEST(HalfEdgeSum, PointsAreThoseOfAnStl) {
  auto triangles = tetrahedron();
  triangles[0][1].y += 1e-12;  // the same float
  EXPECT_TRUE(judged(triangles).first);
  triangles[0][1].y += 1e-6;
  EXPECT_EQ(judged(triangles), std::pair(false, std::uint64_t{4}));
}

TEST(HalfEdgeSum, TwoSurfacesThatShareAnEdge) {
  auto triangles = tetrahedron();
  for (Triangle t : tetrahedron()) {
    for (Vec3& p : t) p.z = -p.z;
    std::swap(t[0], t[1]);
    triangles.push_back(t);
  }
  EXPECT_EQ(judged(triangles), std::pair(true, std::uint64_t{0}));
}

}  // namespace
}  // namespace meso::operations
