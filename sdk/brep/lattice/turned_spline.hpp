// SPDX-License-Identifier: Apache-2.0
#pragma once
// B-spline surfaces that close, with their seam elsewhere. Private.
//
// A curve of intersection ends at the seam, and what is left of it on the other side may be too short to be found.

#include <Geom_BSplineSurface.hxx>
#include <array>

#include "occt.hpp"

namespace meso::brep {

/// The same surface, no longer periodic, that covers half a period on both sides of parameters `at` in each direction
/// in which it closes; up to 1e-7 mm. Null where it closes in none, or not smoothly.
[[nodiscard]] Handle(Geom_BSplineSurface)
    turned_to(const Handle(Geom_BSplineSurface) & surface, const std::array<double, 2>& at);

}  // namespace meso::brep
