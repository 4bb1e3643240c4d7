// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry_values.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"
#include "shape_to_body.hpp"
#include "surface_foot.hpp"
#include "test_bodies.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

double summed_volume(const Body& body) {
  double volume = 0;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) volume += dot(t[0], cross(t[1], t[2])) / 6;
  });
  return volume;
}

constexpr double pi = std::numbers::pi;

std::optional<Body> meshed(const TopoDS_Shape& shape, double deflection = 0.05) {
  DiagnosticSink sink;
  return shape_to_body(shape, {.mesh = MeshTolerance{.deflection_mm = deflection, .angle = 0.5}}, sink);
}

class GapsOf : public testing::TestWithParam<ClosedForm> {};
INSTANTIATE_TEST_SUITE_P(ClosedForms, GapsOf, testing::ValuesIn(closed_forms()),
                         [](const auto& test) { return test.param.name; });

TEST_P(GapsOf, TrianglesAndWhatIsMissingMakeTheVolume) {
  const auto body = meshed(GetParam().shape);
  ASSERT_TRUE(body);
  const Gaps gaps = measure_gaps(*body);
  EXPECT_NEAR(volume_of_triangles(*body), summed_volume(*body), 1e-9 * GetParam().volume);
  EXPECT_NEAR(summed_volume(*body) + gaps.triangles_mm3, GetParam().volume,
              0.1 * gaps.triangles_abs_mm3 + 1e-6 * GetParam().volume);
  EXPECT_LE(std::fabs(gaps.triangles_mm3), gaps.triangles_abs_mm3);
  EXPECT_LT(gaps.edge_mm, 1e-5);
  EXPECT_LT(gaps.vertex_mm, 1e-5);
}

TEST(Gaps, ABallOfTrianglesIsTooSmall) {
  const auto body = meshed(BRepPrimAPI_MakeSphere(2).Solid());
  ASSERT_TRUE(body);
  const Gaps gaps = measure_gaps(*body);
  EXPECT_GT(gaps.triangles_mm3, 0.1);
  EXPECT_GT(gaps.triangle_mm, 0.01);
  EXPECT_LT(gaps.triangle_mm, 0.1);
}

/// A drilled cube, changed.
Gaps after(const std::function<void(Template&)>& damage) {
  const TopoDS_Shape cube = BRepPrimAPI_MakeBox(10, 10, 10).Solid();
  const TopoDS_Shape drill = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(5, 5, -1), gp::DZ()), 2, 12).Solid();
  auto body = meshed(BRepAlgoAPI_Cut(cube, drill).Shape());
  if (!body) return {};
  Template changed = *body->solids[0].outer.geometry;
  damage(changed);
  body->solids[0].outer.geometry = std::make_shared<const Template>(std::move(changed));
  return measure_gaps(*body);
}

TEST(Gaps, ThingsThatWereMovedAreFound) {
  EXPECT_LT(after([](Template&) {}).vertex_mm, 1e-9);
  EXPECT_NEAR(after([](Template& t) { t.vertices[0].x += 0.01; }).vertex_mm, 0.01, 1e-6);
  EXPECT_NEAR(after([](Template& t) {
                for (FaceTemplate& face : t.faces)
                  if (auto* cylinder = std::get_if<CylinderSurface>(&face.surface)) cylinder->radius += 0.02;
              }).edge_mm,
              0.02, 1e-6);
  EXPECT_NEAR(after([](Template& t) {
                for (FaceTemplate& face : t.faces)
                  if (auto* plane = std::get_if<Plane>(&face.surface)) {
                    plane->frame.origin += 0.003 * plane->frame.z;
                    break;
                  }
              }).edge_mm,
              0.003, 1e-6);
  EXPECT_TRUE(std::isnan(after([](Template& t) { t.vertices[0].x = NAN; }).vertex_mm));
  EXPECT_TRUE(std::isnan(after([](Template& t) {
                           for (FaceTemplate& face : t.faces)
                             if (auto* plane = std::get_if<Plane>(&face.surface)) {
                               plane->frame.origin.x = NAN;
                               break;
                             }
                         }).edge_mm));
}

// Near a ball's pole its parameters run close, and OpenCASCADE divides the edge there for the ball's face only.
TEST(Gaps, TrianglesOfABallThatAStrutLeavesBesideThePole) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(0.465).Solid();
  const gp_Ax2 along(gp_Pnt(0, 0, 0), gp_Dir(1.815, 1.55, 2.385), gp::DX());
  const auto body = meshed(BRepAlgoAPI_Fuse(ball, BRepPrimAPI_MakeCylinder(along, 0.3555, 2).Solid()).Shape(), 0.0155);
  ASSERT_TRUE(body);
  const double height = std::sqrt(0.465 * 0.465 - 0.3555 * 0.3555), cap = 0.465 - height;
  const double truth =
      4 * pi / 3 * std::pow(0.465, 3) + pi * 0.3555 * 0.3555 * (2 - height) - pi * cap * cap * (3 * 0.465 - cap) / 3;
  const Gaps gaps = measure_gaps(*body);
  EXPECT_NEAR(summed_volume(*body) + gaps.triangles_mm3, truth, 0.1 * gaps.triangles_abs_mm3);
  EXPECT_LT(gaps.triangle_mm, 3 * 0.0155);
}

// Of a free form OpenCASCADE's triangles were almost five deflections off.
TEST(Gaps, TrianglesOfAStretchedCone) {
  gp_GTrsf stretch;
  stretch.SetVectorialPart(gp_Mat(1, 0, 0, 0, 1, 0, 0, 0, 1.4));
  const TopoDS_Shape cone = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, -1.4687), gp::DZ()), 4.75, 0.916, 5.9687).Solid();
  const TopoDS_Shape without = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, -4), gp::DZ()), 4, 0.916, 8.5).Solid();
  const TopoDS_Shape free_form =
      BRepBuilderAPI_GTransform(BRepAlgoAPI_Cut(cone, without).Shape(), stretch, Standard_True).Shape();
  const auto body = meshed(free_form, 0.025);
  ASSERT_TRUE(body);
  const Gaps gaps = measure_gaps(*body);
  EXPECT_LT(gaps.triangle_mm, 1.5 * 0.025);
  EXPECT_NEAR(summed_volume(*body) + gaps.triangles_mm3, measure(*body).volume, 0.1 * gaps.triangles_abs_mm3);
}

// What faces do not close by, here 1e-7 mm2, moves a volume by no more than that times the body's size.
TEST(Gaps, FarFromTheOriginTheyCountForNoMore) {
  auto body = meshed(BRepPrimAPI_MakeBox(gp_Pnt(1e4, -1e4, 1e4), 2, 2, 2).Solid());
  ASSERT_TRUE(body);
  Template geometry = *body->solids[0].outer.geometry;
  for (FaceTemplate& face : geometry.faces) {
    if (face.box.min.x != face.box.max.x) continue;
    face.moments.vector_area.x += 1e-7;
    face.moments.volume_moment.x += 1e-7 * face.box.min.x;
  }
  body->solids[0].outer.geometry = std::make_shared<Template>(geometry);
  EXPECT_NEAR(measure(*body).volume, 8, 1e-6);
}

// OpenCASCADE reads a curve that goes round as periodic; made plain, its knots go on beyond both ends.
TEST(Gaps, ACurveThatGoesRoundEndsAtItsFirstAndLastKnot) {
  TColgp_Array1OfPnt poles(1, 4);
  for (int i = 1; i <= 4; ++i) poles(i) = gp_Pnt(std::cos(i * pi / 2), std::sin(i * pi / 2), 0.1 * i);
  TColStd_Array1OfReal knots(1, 5);
  for (int i = 1; i <= 5; ++i) knots(i) = i;
  TColStd_Array1OfInteger times(1, 5);
  times.Init(1);
  const Handle(Geom_BSplineCurve) round = new Geom_BSplineCurve(poles, knots, times, 3, Standard_True);
  const Curve value = to_curve(round, 1, 5);
  const auto& spline = std::get<BSplineCurve>(value);
  EXPECT_EQ(spline.multiplicities.front(), 4);
  const Handle(Geom_Curve) plain = to_geom(value);
  const double first = spline.knots.front(), last = spline.knots.back();
  for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0})
    EXPECT_LT(plain->Value(first + share * (last - first)).Distance(round->Value(1 + 4 * share)), 1e-12) << share;
}

// From anywhere to anywhere else: a search that begins at the last answer ends on the far side for a fifth of them.
TEST(Gaps, PointsBesideAnEllipsoidOfABSpline) {
  gp_GTrsf stretch;
  stretch.SetVectorialPart(gp_Mat(1, 0, 0, 0, 2, 0, 0, 0, 6));
  const TopoDS_Shape ellipsoid =
      BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(1).Solid(), stretch, Standard_True).Shape();
  const auto body = meshed(ellipsoid);
  ASSERT_TRUE(body);
  const Surface& surface = body->solids[0].outer.geometry->faces[0].surface;
  ASSERT_TRUE(std::holds_alternative<BSplineSurface>(surface));
  SurfaceFoot foot(surface);
  for (int i = 0; i < 200; ++i) {
    const double turn = 0.7548776662466927 * i;  // anywhere, in no order
    const double u = 2.4 * i, v = std::acos(1 - 2 * (turn - std::floor(turn)));
    const Vec3 on{std::sin(v) * std::cos(u), 2 * std::sin(v) * std::sin(u), 6 * std::cos(v)};
    const Vec3 normal{on.x, on.y / 4, on.z / 36};
    const Vec3 p = on + 0.02 / norm(normal) * normal;
    EXPECT_NEAR(norm(foot(p) - p), 0.02, 1e-6) << i;
    EXPECT_LT(norm(foot(on) - on), 1e-6) << i;
  }
  const Gaps gaps = measure_gaps(*body);
  EXPECT_NEAR(summed_volume(*body) + gaps.triangles_mm3, 16 * std::numbers::pi, 0.1 * gaps.triangles_abs_mm3);
  EXPECT_LT(gaps.triangle_mm, 0.2);  // the far side is 2 away, at least
}

}  // namespace
}  // namespace meso::brep
