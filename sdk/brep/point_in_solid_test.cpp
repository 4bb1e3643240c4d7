// SPDX-License-Identifier: Apache-2.0
#include "point_in_solid.hpp"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Circ.hxx>
#include <gp_Vec.hxx>
#include <numbers>

namespace meso::brep {
namespace {

/// On the unit circle, z from 0 to 1.
TopoDS_Shape regular_prism(int sides) {
  BRepBuilderAPI_MakePolygon polygon;
  for (int i = 0; i < sides; ++i) {
    const double turn = 2 * std::numbers::pi * i / sides;
    polygon.Add(gp_Pnt(std::cos(turn), std::sin(turn), 0));
  }
  polygon.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, 1)).Shape();
}

/// Across the middle of a side, `beyond` outside of it.
Vec3 beside(int sides, int side, double beyond, double z = 0.5) {
  const double turn = std::numbers::pi * (2 * side + 1) / sides;
  const double r = std::cos(std::numbers::pi / sides) + beyond;
  return {r * std::cos(turn), r * std::sin(turn), z};
}

TEST(PointInSolid, KnowsInOnAndOut) {
  for (const int sides : {6, 100}) {  // asked by OpenCASCADE, by facets
    PointInSolid prism(regular_prism(sides));
    for (int side = 0; side < sides; ++side) {
      EXPECT_EQ(prism.state(beside(sides, side, -1e-3), 1e-4), TopAbs_IN) << sides << ' ' << side;
      if (sides == 100) {
        EXPECT_EQ(prism.state(beside(sides, side, -5e-5), 1e-4), TopAbs_ON) << side;
        EXPECT_EQ(prism.state(beside(sides, side, 5e-5), 1e-4), TopAbs_ON) << side;
      }
      EXPECT_EQ(prism.state(beside(sides, side, 1e-3), 1e-4), TopAbs_OUT) << sides << ' ' << side;
      EXPECT_EQ(prism.state(beside(sides, side, -1e-3, -1e-3), 1e-4), TopAbs_OUT) << sides << ' ' << side;
    }
    EXPECT_EQ(prism.state({0, 0, 0.5}, 1e-4), TopAbs_IN);
    EXPECT_TRUE(prism.is_beyond_box({0, 0, 1.1}));
    EXPECT_EQ(prism.state({0, 0, 1.1}, 1e-4), TopAbs_OUT);
  }
}

TEST(PointInSolid, RoundBodies) {
  PointInSolid ball(BRepPrimAPI_MakeSphere(2).Shape());
  EXPECT_EQ(ball.state({1.99, 0, 0}, 1e-4), TopAbs_IN);
  EXPECT_EQ(ball.state({1.2, 1.2, 1.2}, 1e-4), TopAbs_OUT);
}

/// A plate with a hole, as rings of `parts` faces each: round walls inside and outside.
TEST(PointInSolid, RoundBodiesOfManyFacesAreAskedByRays) {
  constexpr int parts = 60;
  BRepBuilderAPI_MakeWire outer, inner;
  const gp_Ax2 axes(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1));
  for (int i = 0; i < parts; ++i) {
    const double from = 2 * std::numbers::pi * i / parts, to = 2 * std::numbers::pi * (i + 1) / parts;
    outer.Add(BRepBuilderAPI_MakeEdge(gp_Circ(axes, 3), from, to).Edge());
    inner.Add(BRepBuilderAPI_MakeEdge(gp_Circ(axes, 1), from, to).Edge());
  }
  BRepBuilderAPI_MakeFace face(outer.Wire());
  face.Add(TopoDS::Wire(inner.Wire().Reversed()));
  PointInSolid plate(BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, 1)).Shape());
  for (int i = 0; i < 500; ++i) {
    const double turn = 0.0126 * i, z = 0.05 + 0.0018 * i;
    const auto at = [&](double r) { return Vec3{r * std::cos(turn), r * std::sin(turn), z}; };
    EXPECT_EQ(plate.state(at(0.999), 1e-4), TopAbs_OUT) << i;
    EXPECT_EQ(plate.state(at(1.001), 1e-4), TopAbs_IN) << i;
    EXPECT_EQ(plate.state(at(1 + 5e-5), 1e-4), TopAbs_ON) << i;
    EXPECT_EQ(plate.state(at(2.9999), 1e-6), TopAbs_IN) << i;
    EXPECT_EQ(plate.state(at(3.0001), 1e-6), TopAbs_OUT) << i;
  }
  EXPECT_EQ(plate.state({0, 0, 0.5}, 1e-6), TopAbs_OUT);
}

}  // namespace
}  // namespace meso::brep
