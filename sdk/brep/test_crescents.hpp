// SPDX-License-Identifier: Apache-2.0
#pragma once
// For tests: faces between two bows with the same ends, on all kinds of surfaces.

#include <Geom2d_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <vector>

#include "occt.hpp"

namespace meso::brep {

struct CrescentOn {
  const char* name;
  Handle(Geom_Surface) surface;
  gp_Pnt2d middle;
  double half, height;  ///< in parameters
};

inline Handle(Geom2d_BezierCurve) bow(double half, double height) {
  TColgp_Array1OfPnt2d poles(1, 3);
  poles(1) = {-half, 0};
  poles(2) = {0, 2 * height};
  poles(3) = {half, 0};
  return new Geom2d_BezierCurve(poles);
}

inline Handle(Geom2d_BezierCurve) moved(const Handle(Geom2d_BezierCurve) & curve, double from, double to, gp_Vec2d by) {
  const Handle(Geom2d_BezierCurve) out = Handle(Geom2d_BezierCurve)::DownCast(curve->Copy());
  out->Segment(from, to);
  out->Translate(by);
  return out;
}

/// Between two bows with the same ends in the plane of the parameters; the lower one has a corner on its way, so that
/// points of the one have none of the other beside them.
inline TopoDS_Face crescent(const CrescentOn& on, double width) {
  const auto& [name, surface, middle, half, height] = on;
  const gp_Vec2d by(middle.X(), middle.Y());
  const auto low = bow(half, height), high = bow(half, height + width);
  constexpr double corner = 0.37;
  const auto vertex = [&](const gp_Pnt2d& p) {
    TopoDS_Vertex out;
    BRep_Builder().MakeVertex(out, surface->Value(p.X() + by.X(), p.Y() + by.Y()), 1e-7);
    return out;
  };
  const TopoDS_Vertex left = vertex(low->Value(0)), on_way = vertex(low->Value(corner)), right = vertex(low->Value(1));
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(moved(low, 0, corner, by), surface, left, on_way).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(moved(low, corner, 1, by), surface, on_way, right).Edge());
  wire.Add(TopoDS::Edge(BRepBuilderAPI_MakeEdge(moved(high, 0, 1, by), surface, left, right).Edge().Reversed()));
  TopoDS_Face face = BRepBuilderAPI_MakeFace(surface, wire.Wire(), true).Face();
  BRepLib::BuildCurves3d(face);
  BRepLib::SameParameter(face, 1e-6);
  return face;
}

inline Handle(Geom_Surface) saddle() {
  TColgp_Array2OfPnt poles(1, 3, 1, 3);
  for (int i = 1; i <= 3; ++i)
    for (int k = 1; k <= 3; ++k) poles(i, k) = {i - 2.0, k - 2.0, 0.8 * (i - 2) * (k - 2) + (i == 2 ? 0.7 : 0)};
  return GeomConvert::SurfaceToBSplineSurface(new Geom_BezierSurface(poles));
}

inline std::vector<CrescentOn> crescents() {
  const gp_Ax3 axes(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(1, 2, 3));
  return {{"Cylinder", new Geom_CylindricalSurface(axes, 0.5), {1, 0}, 0.9, 0.4},
          {"Cone", new Geom_ConicalSurface(axes, 0.4, 0.5), {1, 0.1}, 0.9, 0.3},
          {"Sphere", new Geom_SphericalSurface(axes, 0.5), {1, 0.2}, 0.9, 0.5},
          {"Torus", new Geom_ToroidalSurface(axes, 1, 0.4), {1, 0.2}, 0.5, 0.9},
          {"Spline", saddle(), {0.5, 0.3}, 0.4, 0.4}};
}

}  // namespace meso::brep
