// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/clear_triangles.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>

#include "meso/brep/placement.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/mesh/audit_mesh.hpp"
#include "meso/mesh/self_contact.hpp"
#include "surface_point.hpp"

namespace meso::brep {
namespace {

/// A ball as an octahedron, turned: as coarse as can be.
Template ball(double radius, double turn, bool inwards) {
  Template geometry;
  FaceTemplate face{.surface = SphereSurface{{}, radius}, .reversed = inwards};
  const double c = radius * std::cos(turn), s = radius * std::sin(turn);
  for (const Vec3 p :
       {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{-c, -s, 0}, Vec3{s, -c, 0}, Vec3{0, 0, radius}, Vec3{0, 0, -radius}})
    face.mesh.points.push_back({p});
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t k = (i + 1) % 4;
    face.mesh.triangles.push_back({i, k, 4});
    face.mesh.triangles.push_back({k, i, 5});
  }
  if (inwards)
    for (auto& t : face.mesh.triangles) std::swap(t[0], t[1]);
  geometry.faces = {face};
  return geometry;
}

TriangleMesh welded(const Body& body) {
  TriangleMesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) {
      auto& out = mesh.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [number, fresh] =
            numbers.try_emplace({t[k].x, t[k].y, t[k].z}, static_cast<std::uint32_t>(mesh.points.size()));
        if (fresh) mesh.points.push_back(t[k]);
        out[k] = number->second;
      }
    }
  });
  return mesh;
}

TEST(ClearTriangles, AThinWallBetweenBallsIsKept) {
  Body body;
  body.solids = {{whole_template(std::make_shared<const Template>(ball(1.05, 0.4, false))),
                  {whole_template(std::make_shared<const Template>(ball(1, 0, true)))}}};
  EXPECT_GT(count_self_contacts(welded(body)).pairs, 0u);
  EXPECT_EQ(clear_triangles(body, {}), 0u);
  const TriangleMesh mesh = welded(body);
  EXPECT_EQ(count_self_contacts(mesh).pairs, 0u);
  EXPECT_TRUE(audit_mesh(mesh).watertight());
  for (const Vec3 p : mesh.points) EXPECT_NEAR(std::min(std::abs(norm(p) - 1), std::abs(norm(p) - 1.05)), 0, 1e-12);
  EXPECT_LT(mesh.triangles.size(), 2000u);
}

TEST(ClearTriangles, InstancesOfOneTemplateStayOneTemplate) {
  Template both = ball(1.05, 0.4, false);
  both.faces.push_back(ball(1, 0, true).faces[0]);
  both.lattice = {{3, 0, 0, 0, 3, 0, 0, 0, 3}};
  const auto geometry = std::make_shared<const Template>(both);
  Body body;
  for (std::int32_t i = 0; i < 20; ++i)
    body.solids.push_back({{geometry,
                            {},
                            [i](const auto& visit) {
                              visit({0, {i, 0, 0}}), visit({1, {i, 0, 0}});
                            }},
                           {}});
  EXPECT_GT(count_self_contacts(welded(body)).pairs, 0u);
  EXPECT_EQ(clear_triangles(body, {}), 0u);
  const TriangleMesh mesh = welded(body);
  EXPECT_EQ(count_self_contacts(mesh).pairs, 0u);
  EXPECT_TRUE(audit_mesh(mesh).watertight());
  for (const Solid& solid : body.solids) EXPECT_EQ(solid.outer.geometry, body.solids[0].outer.geometry);
  EXPECT_EQ(geometry->faces[0].mesh.triangles.size(), 8u);  // what others hold is not changed
}

TEST(ClearTriangles, BodiesThatTouchAreTold) {
  Body body;
  const auto geometry = std::make_shared<const Template>(ball(1, 0.3, false));
  body.solids = {{whole_template(geometry), {}},
                 {whole_template(geometry, Affine::from_translation({1, 0.2, 0.1})), {}}};
  EXPECT_GT(clear_triangles(body, {.deadline = std::chrono::steady_clock::now()}), 0u);
  EXPECT_GT(clear_triangles(body, {}), 0u);
  EXPECT_EQ(body.solids[0].outer.geometry, geometry);
  EXPECT_EQ(body.solids[0].outer.geometry->faces[0].mesh.triangles.size(), 8u);
}

TEST(ClearTriangles, WhereBodiesTouchOthersAreClearedAllTheSame) {
  Body body;
  const auto geometry = std::make_shared<const Template>(ball(1, 0.3, false));
  const Vec3 away{10, 0, 0};
  body.solids = {
      {whole_template(geometry), {}},
      {whole_template(geometry, Affine::from_translation({1, 0.2, 0.1})), {}},
      {whole_template(std::make_shared<const Template>(ball(1.05, 0.4, false)), Affine::from_translation(away)),
       {whole_template(std::make_shared<const Template>(ball(1, 0, true)), Affine::from_translation(away))}}};
  Body apart;
  apart.solids = {body.solids[2]};
  ASSERT_GT(count_self_contacts(welded(apart)).pairs, 0u);
  const std::size_t left = clear_triangles(body, {});
  EXPECT_GT(left, 0u);
  EXPECT_LE(left, 16u);
  apart.solids = {body.solids[2]};
  EXPECT_EQ(count_self_contacts(welded(apart)).pairs, 0u);
  EXPECT_TRUE(audit_mesh(welded(apart)).watertight());
  EXPECT_EQ(body.solids[0].outer.geometry->faces[0].mesh.triangles.size(), 8u);
}

TEST(NearestPoint, LiesOnTheSurfaceAndNoOtherIsNearer) {
  const AxisFrame frame{{1, 2, 3}, Vec3{1, 2, 2} / 3, Vec3{2, -1, 0} / std::sqrt(5)};
  const Vec3 y = cross(frame.z, frame.x);
  const auto at = [&](double u, double r, double h) {
    return frame.origin + r * (std::cos(u) * frame.x + std::sin(u) * y) + h * frame.z;
  };
  const Vec3 p = at(0.7, 1.65, 0.4);
  const auto expect_nearest = [&](const Surface& surface, const auto& point_at) {
    const double found = norm(nearest_point(surface, p) - p);
    double nearest = HUGE_VAL;
    for (int i = -400; i <= 400; ++i) nearest = std::min(nearest, norm(point_at(i / 100.0) - p));
    EXPECT_NEAR(found, nearest, 1e-4);
    EXPECT_NEAR(norm(nearest_point(surface, nearest_point(surface, p)) - nearest_point(surface, p)), 0, 1e-14);
  };
  expect_nearest(Plane{frame}, [&](double t) { return at(0.7, 1.7 + t, 0); });
  expect_nearest(CylinderSurface{frame, 1.2}, [&](double t) { return at(0.7, 1.2, t); });
  expect_nearest(ConeSurface{frame, 1.2, 0.3}, [&](double t) { return at(0.7, 1.2 + t * std::tan(0.3), t); });
  expect_nearest(SphereSurface{frame, 1.1}, [&](double t) { return at(0.7, 1.1 * std::cos(t), 1.1 * std::sin(t)); });
  expect_nearest(TorusSurface{frame, 2, 0.5},
                 [&](double t) { return at(0.7, 2 + 0.5 * std::cos(t), 0.5 * std::sin(t)); });
}

TEST(NearestPoint, LiesOnTheSurfaceWhereSeveralAreNearest) {
  const AxisFrame frame{{1, 2, 3}, {0, 0, 1}, {1, 0, 0}};
  const auto off = [&](const Surface& surface, Vec3 p) { return norm(nearest_point(surface, p) - p); };
  EXPECT_NEAR(off(SphereSurface{frame, 2}, frame.origin), 2, 1e-15);
  EXPECT_NEAR(off(CylinderSurface{frame, 2}, {1, 2, 7}), 2, 1e-15);
  EXPECT_NEAR(off(TorusSurface{frame, 3, 1}, frame.origin), 2, 1e-15);
  EXPECT_NEAR(off(TorusSurface{frame, 3, 1}, {4, 2, 3}), 1, 1e-15);
  EXPECT_NEAR(off(ConeSurface{frame, 1, std::atan(0.5)}, {1, 2, -9}), 10, 1e-14);  // its apex is at z = 1
  EXPECT_NEAR(off(ConeSurface{frame, 1, std::atan(0.5)}, frame.origin), std::cos(std::atan(0.5)), 1e-15);
}

}  // namespace
}  // namespace meso::brep
