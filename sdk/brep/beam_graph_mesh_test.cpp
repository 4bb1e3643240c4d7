// SPDX-License-Identifier: Apache-2.0
// Triangles of balls. Truths: a sphere's distance, sampled.
#include "beam_graph_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

/// How deep triangles lie below the unit sphere, in samples all over each.
double depth_of(const Triangulation& mesh) {
  double deepest = 0;
  for (const auto& corners : mesh.triangles)
    for (int a = 0; a <= 10; ++a)
      for (int b = 0; a + b <= 10; ++b) {
        const Vec3 p = 0.1 * a * mesh.points[corners[0]].point + 0.1 * b * mesh.points[corners[1]].point +
                       0.1 * (10 - a - b) * mesh.points[corners[2]].point;
        deepest = std::max(deepest, 1 - norm(p));
      }
  return deepest;
}

/// Around a square on the unit sphere: triangles with right angles are deepest on a side that two share.
TEST(SphereMesh, NoTriangleIsDeeperThanAskedFor) {
  for (const double half : {0.2, 0.24, 0.4, 0.6, 0.9})
    for (const double deflection : {0.03, 0.02, 0.005}) {
      std::vector<Vec3> loop;
      const int sides = 1 + static_cast<int>(half / std::acos(1 - deflection));
      for (int side = 0; side < 4; ++side)
        for (int i = 0; i < sides; ++i) {
          const double y = std::sin(half), z = y * (2.0 * i / sides - 1), turn = side * pi / 2;
          const Vec3 p{std::cos(half), std::cos(turn) * y - std::sin(turn) * z,
                       std::sin(turn) * y + std::cos(turn) * z};
          loop.push_back(p / norm(p));
        }
      const auto mesh = sphere_mesh(SphereSurface{{}, 1}, {loop}, deflection, 0.5, {});
      ASSERT_TRUE(mesh) << half << ' ' << deflection;
      EXPECT_LE(depth_of(*mesh), deflection * (1 + 1e-5)) << half << ' ' << deflection;
    }
}

}  // namespace
}  // namespace meso::brep
