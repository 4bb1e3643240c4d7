// SPDX-License-Identifier: Apache-2.0
#pragma once
// Intersections of faces without the curves along which they only touch. Private.
//
// A plane that touches a cylinder parts neither of them, and the line of contact is as a rule but a part of a line on
// the one or the other: it ends within a face. OpenCASCADE returns such lines among those along which faces cut each
// other.

#include <BOPAlgo_PaveFiller.hxx>
#include <IntTools_Context.hxx>

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
 protected:
  void PerformFF(const Message_ProgressRange& range) override;
};

}  // namespace meso::brep
