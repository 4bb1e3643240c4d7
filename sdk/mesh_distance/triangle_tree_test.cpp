// SPDX-License-Identifier: Apache-2.0
#include "triangle_tree.hpp"

#include <gtest/gtest.h>

#include "clean_mesh.hpp"
#include "test_meshes.hpp"
#include "winding_number.hpp"

namespace meso::implicit {
namespace {

TriangleTree tree_of(const TriangleMesh& mesh) {
  const RunOptions options;
  StopPoll stop(options);
  DiagnosticSink sink;
  CleanMesh clean = *clean_mesh(mesh, "mesh", stop, sink);
  return {std::move(clean.triangles), clean.box, stop};
}

/// Triangles of all sizes and shapes, needles and repeated corners among them.
TriangleMesh soup(int triangles, unsigned seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int t = 0; t < triangles; ++t) {
    const Vec3 a = random.in_cube(1), u = std::exp(random.in(-8, 0)) * random.in_cube(1);
    const Vec3 v = t % 5 == 0 ? (1 + 1e-9) * u : t % 7 == 0 ? Vec3{} : std::exp(random.in(-8, 0)) * random.in_cube(1);
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), {a, a + u, a + v});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(TriangleTree, FindsTheNearestTriangle) {
  for (const int size : {1, 2, 5, 64, 3000}) {
    const TriangleMesh mesh = soup(size, unsigned(size));
    const TriangleTree tree = tree_of(mesh);
    Random random(31);
    for (int n = 0; n < 200; ++n) {
      const Vec3 p = std::exp(random.in(-3, 8)) * random.in_cube(1);
      const double exact = static_cast<double>(slow_distance(mesh, p));
      ASSERT_NEAR(std::sqrt(tree.nearest(p).squared_distance), exact, 1e-12 * exact + 1e-15);
    }
  }
}

TEST(TriangleTree, FindsTheSameFromEveryHint) {
  const TriangleMesh mesh = soup(2000, 32);
  const TriangleTree tree = tree_of(mesh);
  Random random(33);
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = random.in_cube(n % 2 == 0 ? 1.5 : 1000);
    const double d2 = tree.nearest(p).squared_distance;
    for (int h = 0; h < 5; ++h)
      ASSERT_EQ(tree.nearest(p, static_cast<std::uint32_t>(random.in(0, 2000))).squared_distance, d2);
    ASSERT_EQ(tree.nearest(p, TriangleTree::no_triangle, std::sqrt(d2)).squared_distance, d2);
    ASSERT_GE(tree.nearest(p, TriangleTree::no_triangle, 0.9 * std::sqrt(d2)).squared_distance, d2);
  }
}

TEST(TriangleTree, HoldsEveryTriangleOnce) {
  const TriangleMesh mesh = soup(5000, 34);
  const TriangleTree tree = tree_of(mesh);
  std::vector<int> seen(5000, 0);
  using Node = TriangleTree::Node;
  for (const Node& node : tree.nodes()) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(node.low[0][i] <= node.high[0][i]) || (node.child[i] & Node::leaf) == 0) continue;
      const std::uint32_t first = node.child[i] & Node::first_mask;
      const std::uint32_t last = first + ((node.child[i] & ~Node::leaf) >> Node::count_shift);
      for (std::uint32_t t = first; t <= last; ++t) ++seen[t];
    }
  }
  EXPECT_EQ(seen, std::vector<int>(5000, 1));
}

TEST(TriangleTree, WindingsOfClosedSurfacesAreSolidAngles) {
  const TriangleMesh ball = icosphere(2);
  const TriangleMesh mesh = together(together(ball, moved(ball, Affine::from_translation({0.5, 0.2, 0}))),
                                     inverted(moved(ball, Affine::from_translation({-0.4, 0, 0.3}))));
  const TriangleTree tree = tree_of(mesh);
  Random random(35);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p = random.in_cube(1.2);
    ASSERT_NEAR(tree.winding(p).number, solid_angle_winding(mesh, p), 1e-6);
  }
}

TEST(WindingNumber, IsTheSumOfSolidAnglesAlsoOfSoups) {
  const TriangleMesh mesh = soup(3000, 36);
  const TriangleTree tree = tree_of(mesh);
  const WindingNumber winding(tree);
  Random random(37);
  double area = 0;
  for (const Triangle& t : tree.triangles()) area += norm(cross(t[1] - t[0], t[2] - t[0]));
  ASSERT_GT(area, 1);
  for (int n = 0; n < 300; ++n) {
    const Vec3 p = random.in_cube(n % 2 == 0 ? 1 : 4);
    ASSERT_NEAR(winding.at(tree, p), solid_angle_winding(mesh, p), 0.02);
  }
}

}  // namespace
}  // namespace meso::implicit
