// SPDX-License-Identifier: Apache-2.0
#include "light.hpp"

#include <gtest/gtest.h>

#include "shapes_for_test.hpp"

namespace meso::picture {
namespace {

/// The first mesh with the second beside it.
TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& more) {
  for (const auto& t : more.triangles) add_triangle(mesh, more.points[t[0]], more.points[t[1]], more.points[t[2]]);
  return mesh;
}

/// Green light from the spot that a level ray meets, averaged over many pixels' samples.
double light_at(const TriangleMesh& mesh, Vec3 from, Vec3 direction) {
  const Surface surface(mesh);
  const auto tracer = Tracer::over(surface);
  if (!tracer) return -1;
  const Studio studio(view_for({.up = Up::z}, {}), *tracer);
  const auto hit = tracer->first_hit(from, direction);
  if (!hit) return -1;
  double sum = 0;
  for (std::uint32_t x = 0; x < 64; ++x) {
    Samples samples(x, 7);
    sum += studio.shade(surface.at(hit->triangle, hit->u, hit->v), -direction, samples).y;
  }
  return sum / 64;
}

TEST(Studio, ACanopyTakesTheLampAndMostOfTheSky) {
  const TriangleMesh floor = box_soup({-10, -10, -5}, {10, 10, -4}), roof = box_soup({-10, -10, -3}, {10, 10, -2});
  const TriangleMesh below = box_soup({-10, -10, -9}, {10, 10, -8});
  const Vec3 down = normalized({0.9, 0, -0.1});
  // The scene is scaled into the unit ball, so the start is given there: above the floor, under the roof.
  const double open = light_at(joined(floor, below), {-0.4, 0, 0.28}, down);
  const double covered = light_at(joined(floor, roof), {-0.4, 0, 0.0}, down);
  ASSERT_GT(open, 0);
  ASSERT_GT(covered, 0);
  EXPECT_LT(covered, 0.35 * open);
}

TEST(Studio, LightIsNeverNegativeOrEndless) {
  const TriangleMesh ball = sphere_soup(1, 24);
  for (const Vec3 from : {Vec3{3, 0, 0.2}, Vec3{0.1, -3, 0}, Vec3{0, 0.1, 3}, Vec3{0.1, 0, -3}}) {
    const double light = light_at(ball, from, normalized(-from));
    EXPECT_GT(light, 0);
    EXPECT_LT(light, 4);
  }
}

TEST(Samples, FillTheUnitSquareEvenly) {
  // Any 64 neighbours in the sequence put 12 to 20 points into each quarter of the square.
  for (std::uint32_t x = 0; x < 50; ++x) {
    Samples samples(x, 3 * x + 1);
    std::array<int, 4> quarter{};
    for (int i = 0; i < 64; ++i) {
      const Samples::Point p = samples.next();
      ASSERT_TRUE(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1);
      ++quarter[(p.u < 0.5 ? 0 : 1) + (p.v < 0.5 ? 0 : 2)];
    }
    for (const int n : quarter) EXPECT_NEAR(n, 16, 4) << "pixel " << x;
  }
}

}  // namespace
}  // namespace meso::picture
