// SPDX-License-Identifier: Apache-2.0
#pragma once
// Intersections of faces, along well-known curves and without those along which they only touch. Private.
//
// A plane that touches a cylinder parts neither of them, and the line of contact is as a rule but a part of a line on
// the one or the other: it ends within a face. OpenCASCADE returns such lines among those along which faces cut each
// other.
//
// A curve of its on a B-spline surface is known to a hundredth of the cell. Vertices within that of each other are one
// to it, as where a face ends in a tip between two circles and is cut near it: curves are fitted to both surfaces
// first.

#include <BOPAlgo_PaveFiller.hxx>
#include <IntTools_Context.hxx>
#include <TopTools_MapOfShape.hxx>

#include "occt.hpp"

namespace meso::brep {

struct CurveSpan {
  Handle(Geom_Curve) curve;
  double from = 0, to = 0;
};

/// Whether both faces have the same tangent plane along a curve that lies in both.
[[nodiscard]] bool touch_along(const TopoDS_Face& a, const TopoDS_Face& b, const CurveSpan& span,
                               const Handle(IntTools_Context) & context);

class CrossingFiller : public BOPAlgo_PaveFiller {
 public:
  /// Lengths below 1e-6 of `size` do not count.
  explicit CrossingFiller(double size) : size_(size) {}

  /// Edges that meet no face of another argument. OpenCASCADE intersects each edge with each face whose box it meets,
  /// and a face across a cell has a box as large as the cell; with a B-spline surface each takes a millisecond.
  void leave_out(const TopTools_MapOfShape& edges) { away_ = edges; }

 protected:
  void Init(const Message_ProgressRange& range) override;
  void PerformFF(const Message_ProgressRange& range) override;

 private:
  /// Between those faces, numbered as in the data structure; as it was where the surfaces nearly touch.
  [[nodiscard]] BOPDS_Curve fitted(const BOPDS_Curve& curve, int a, int b) const;

  double size_;
  TopTools_MapOfShape away_;
};

}  // namespace meso::brep
