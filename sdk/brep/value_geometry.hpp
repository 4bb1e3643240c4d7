// SPDX-License-Identifier: Apache-2.0
#pragma once
// Plain values to OpenCASCADE surfaces and curves: the way back of geometry_values.hpp. Private.

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

[[nodiscard]] Handle(Geom_Surface) to_geom(const Surface& surface);
[[nodiscard]] Handle(Geom_Curve) to_geom(const Curve& curve);

/// The parameters of a curve between two points on it, first < last; a closed curve has the same point twice.
struct CurveRange {
  double first = 0, last = 0;
};
[[nodiscard]] CurveRange range_between(const Curve& curve, Vec3 from, Vec3 to, bool closed);

}  // namespace meso::brep
