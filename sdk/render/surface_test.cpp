// SPDX-License-Identifier: Apache-2.0
#include "surface.hpp"

#include <gtest/gtest.h>

#include "camera.hpp"
#include "shapes_for_test.hpp"

namespace meso::picture {
namespace {

TEST(Surface, WeldsASoupAndScalesItIntoTheUnitBall) {
  const Surface surface(box_soup({100, 0, 0}, {102, 4, 4}));
  EXPECT_EQ(surface.points().size(), 8U);
  EXPECT_EQ(surface.triangles().size(), 12U);
  for (const Vec3& p : surface.points()) EXPECT_NEAR(norm(p), 1, 1e-14);
}

TEST(Surface, MinusZeroIsZero) {
  TriangleMesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(mesh, {-0.0, 0, -0.0}, {0, 1, 0}, {-1, 0, 0});
  mesh.points.push_back({1, -1, 0});
  mesh.points.push_back({-1, -1, 0});
  EXPECT_EQ(Surface(mesh).points().size(), 4U);
}

TEST(Surface, TrianglesWithoutAreaAreDropped) {
  TriangleMesh mesh = box_soup({0, 0, 0}, {1, 1, 1});
  add_triangle(mesh, {0, 0, 0}, {0.5, 0.5, 0.5}, {1, 1, 1});
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(Surface(mesh).triangles().size(), 12U);
}

TEST(Surface, ASphereIsSmooth) {
  const Surface surface(sphere_soup(7, 12));  // facets 15 degrees apart
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) {
    const Surface::Spot spot = surface.at(t, 0.3, 0.45);
    EXPECT_GT(dot(spot.normal, normalized(spot.position)), std::cos(0.06)) << "triangle " << t;
    EXPECT_GT(norm(spot.lifted), norm(spot.position)) << "triangle " << t;
    EXPECT_LT(norm(spot.lifted), 1.02) << "triangle " << t;
  }
}

TEST(Surface, ACubeKeepsItsEdges) {
  const Surface surface(box_soup({0, 0, 0}, {1, 1, 1}));
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) {
    const Surface::Spot spot = surface.at(t, 0.9, 0.05);
    EXPECT_NEAR(norm(spot.normal - spot.facet_normal), 0, 1e-12) << "triangle " << t;
    EXPECT_NEAR(norm(spot.lifted - spot.position), 0, 1e-12) << "triangle " << t;
  }
}

TEST(Surface, NothingIsEmpty) { EXPECT_TRUE(Surface(TriangleMesh{}).triangles().empty()); }

}  // namespace
}  // namespace meso::picture
