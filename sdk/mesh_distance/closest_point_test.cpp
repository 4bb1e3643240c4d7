// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/closest_point.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

/// Against long double, from far, near, and beside: to 1e-12 of the distance, or of half a triangle of size 1 where the
/// distance is smaller still.
void expect_exact(const Triangle& triangle, Random& random) {
  const TriangleMesh mesh{{triangle[0], triangle[1], triangle[2]}, {{0, 1, 2}}};
  for (int n = 0; n < 300; ++n) {
    const double u = random.in(-0.5, 1.5), v = random.in(-0.5, 1.5);
    const Vec3 in_plane = triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
    const Vec3 p = in_plane + std::exp(random.in(-30, 5)) * random.in_cube(1);
    const double d = norm(to_closest_point(triangle, p));
    const long double exact = slow_distance(mesh, p);
    ASSERT_TRUE(std::isfinite(d));
    ASSERT_LE(std::abs(static_cast<double>(d - exact)), 1e-12 * (static_cast<double>(exact) + 0.02))
        << "p " << p.x << " " << p.y << " " << p.z << ": " << d << " " << static_cast<double>(exact);
  }
}

TEST(ClosestPoint, NeedlesOfEveryWidth) {
  Random random(3);
  for (double width = 1; width > 1e-17; width /= 10) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 a = random.in_cube(0.5), along = random.in_cube(0.5), side = width * random.in_cube(0.5);
      expect_exact({a, a + along, a + side}, random);
      expect_exact({a, a + along, a + along + side}, random);
    }
  }
}

TEST(ClosestPoint, CapsOfEveryHeight) {
  Random random(4);
  for (double height = 1; height > 1e-17; height /= 10) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 a = random.in_cube(0.5), b = random.in_cube(0.5);
      expect_exact({a, b, a + random.in(0.1, 0.9) * (b - a) + height * random.in_cube(0.5)}, random);
    }
  }
}

TEST(ClosestPoint, SegmentsAndPoints) {
  Random random(5);
  for (int n = 0; n < 50; ++n) {
    const Vec3 a = random.in_cube(0.5), b = random.in_cube(0.5);
    expect_exact({a, a, a}, random);
    expect_exact({a, a, b}, random);
    expect_exact({a, b, a}, random);
    expect_exact({b, a, a}, random);
    expect_exact({a, b, 0.5 * a + 0.5 * b}, random);
    expect_exact({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{random.in(-1, 2), 0, 0}}, random);
  }
}

TEST(ClosestPoint, SmallTrianglesFromFar) {
  Random random(6);
  for (double size = 1; size > 1e-9; size /= 10) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 a = random.in_cube(0.5);
      expect_exact({a, a + size * random.in_cube(1), a + size * random.in_cube(1)}, random);
    }
  }
}

}  // namespace
}  // namespace meso::implicit
