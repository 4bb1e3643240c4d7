// SPDX-License-Identifier: Apache-2.0
#pragma once
// OpenCASCADE surfaces and curves to plain values: elementary ones as they are, all others as B-splines. Private.
//
//   const SurfaceValue s = to_surface(geom_surface);   // s.flipped: du x dv is against the value's own normal
//
// Throws Standard_Failure where OCCT cannot convert.

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct SurfaceValue {
  Surface surface;
  bool flipped = false;  ///< the value's normal is the opposite of du x dv (left-handed axes)
};

/// Only the part over [u_min, u_max] x [v_min, v_max] is kept where a conversion to B-spline is needed.
struct UvBounds {
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
};
[[nodiscard]] SurfaceValue to_surface(const Handle(Geom_Surface) & surface, const UvBounds& bounds);

/// The curve over [first, last]; B-splines are cut to it.
[[nodiscard]] Curve to_curve(const Handle(Geom_Curve) & curve, double first, double last);

}  // namespace meso::brep
