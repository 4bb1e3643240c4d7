// SPDX-License-Identifier: Apache-2.0
#include "shape_to_body.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

struct ClosedForm {
  std::string name;
  TopoDS_Shape shape;
  double volume, area;
  Vec3 centroid;
  double tolerance = 1e-9;  // relative
};

const gp_Ax2 tilted(gp_Pnt(3, -2, 5), gp_Dir(1, 2, 3));

TopoDS_Shape ellipsoid(double a, double b, double c) {
  gp_GTrsf stretch;
  stretch.SetValue(1, 1, a);
  stretch.SetValue(2, 2, b);
  stretch.SetValue(3, 3, c);
  return BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(1).Shape(), stretch, Standard_True).Shape();
}

// The intersection of two cylinders of radius r that cross at right angles: 16 r^3 / 3.
TopoDS_Shape steinmetz(double r) {
  const TopoDS_Shape along_z = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -3 * r), gp::DZ()), r, 6 * r).Shape();
  const TopoDS_Shape along_x = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-3 * r, 0, 0), gp::DX()), r, 6 * r).Shape();
  return BRepAlgoAPI_Common(along_z, along_x).Shape();
}

std::vector<ClosedForm> closed_forms() {
  const Vec3 axis = Vec3{1, 2, 3} / std::sqrt(14.0), at{3, -2, 5};
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), 4, 5, 6).Shape();
  const double slant = std::hypot(2, 4);
  // Area of an ellipsoid of revolution with half axes 2, 2, 4 (prolate): 2 pi a^2 (1 + c / (a e) asin e).
  const double e = std::sqrt(1 - 4.0 / 16);
  return {
      {"box", box, 120, 148, {3, 4.5, 6}},
      {"sphere", BRepPrimAPI_MakeSphere(tilted, 2).Shape(), 32 * pi / 3, 16 * pi, at},
      {"cylinder", BRepPrimAPI_MakeCylinder(tilted, 2, 5).Shape(), 20 * pi, 28 * pi, at + 2.5 * axis},
      {"cone", BRepPrimAPI_MakeCone(tilted, 2, 0, 4).Shape(), 16 * pi / 3, pi * 2 * (2 + slant), at + 1.0 * axis},
      {"cone_that_widens", BRepPrimAPI_MakeCone(tilted, 0, 2, 4).Shape(), 16 * pi / 3, pi * 2 * (2 + slant),
       at + 3.0 * axis},
      {"torus", BRepPrimAPI_MakeTorus(tilted, 5, 1).Shape(), 10 * pi * pi, 20 * pi * pi, at},
      {"ellipsoid", ellipsoid(2, 2, 4), 4 * pi / 3 * 16, 2 * pi * 4 * (1 + 4 / (2 * e) * std::asin(e)), {}, 1e-8},
      {"box_with_spherical_void",
       BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeSphere(gp_Pnt(3, 4.5, 6), 1.5).Shape()).Shape(),
       120 - 4.5 * pi,
       148 + 9 * pi,
       {3, 4.5, 6}},
      {"steinmetz", steinmetz(1.5), 16 * 1.5 * 1.5 * 1.5 / 3, 16 * 1.5 * 1.5, {}, 1e-7},
  };
}

class ShapeToBody : public testing::TestWithParam<ClosedForm> {};
INSTANTIATE_TEST_SUITE_P(ClosedForms, ShapeToBody, testing::ValuesIn(closed_forms()),
                         [](const auto& test) { return test.param.name; });

TEST_P(ShapeToBody, MeasuresLikeTheClosedForm) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body) << (sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]));
  const Measures m = measure(*body);
  EXPECT_NEAR(m.volume / GetParam().volume, 1, GetParam().tolerance);
  EXPECT_NEAR(m.area / GetParam().area, 1, GetParam().tolerance);
  EXPECT_NEAR(norm(m.centroid - GetParam().centroid), 0, 1e-7);
  EXPECT_EQ(m.solids, 1u);
}

TEST_P(ShapeToBody, IsClosedAndOriented) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body);
  const Audit a = audit(*body);
  EXPECT_TRUE(a.clean()) << a.free_edges << " free, " << a.multiple_edges << " multiple, " << a.conflicts
                         << " conflicts, " << a.open_loops << " open loops, " << a.components << " components";
}

}  // namespace
}  // namespace meso::brep
