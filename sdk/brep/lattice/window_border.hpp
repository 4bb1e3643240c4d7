// SPDX-License-Identifier: Apache-2.0
#pragma once
// Edges of a face in its parameters, and the sides of a window there. Private.

#include <ElSLib.hxx>

#include "lattice/face_windows.hpp"

namespace meso::brep {

using FaceParameters = std::array<double, 2>;

/// Of points of an edge, on a face that has it.
class EdgeOnFace {
 public:
  EdgeOnFace(const TopoDS_Edge& edge, const TopoDS_Face& face) : surface_(face, false) {
    double first = 0, last = 0;
    curve_ = BRep_Tool::Curve(edge, first, last);
    if (surface_.GetType() != GeomAbs_Plane) on_face_ = BRep_Tool::CurveOnSurface(edge, face, first, last);
  }
  [[nodiscard]] bool known() const {
    return !curve_.IsNull() && (surface_.GetType() == GeomAbs_Plane || !on_face_.IsNull());
  }
  [[nodiscard]] Vec3 place(double t) const { return to_vec(curve_->Value(t)); }
  [[nodiscard]] FaceParameters at(double t) const {
    FaceParameters out{};
    if (!on_face_.IsNull()) {
      const gp_Pnt2d p = on_face_->Value(t);
      return {p.X(), p.Y()};
    }
    ElSLib::Parameters(surface_.Plane(), curve_->Value(t), out[0], out[1]);
    return out;
  }

 private:
  BRepAdaptor_Surface surface_;
  Handle(Geom_Curve) curve_;
  Handle(Geom2d_Curve) on_face_;
};

/// The border_sides of a window, counter-clockwise: which parameter is fixed, at which end, and which way the other one
/// runs.
struct BorderSide {
  std::size_t fixed;
  bool high, falling;
};
inline constexpr std::array<BorderSide, 4> border_sides{
    {{1, false, false}, {0, true, false}, {1, true, true}, {0, false, true}}};

inline double fixed_at(const ParameterRange& window, const BorderSide& side) {
  return side.high ? window.high[side.fixed] : window.low[side.fixed];
}

inline TopoDS_Vertex first_of(const TopoDS_Edge& edge) { return TopExp::FirstVertex(edge, true); }
inline TopoDS_Vertex last_of(const TopoDS_Edge& edge) { return TopExp::LastVertex(edge, true); }

}  // namespace meso::brep
