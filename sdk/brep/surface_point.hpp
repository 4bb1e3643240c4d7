// SPDX-License-Identifier: Apache-2.0
#pragma once
// The point of a surface that is nearest to a point, where a formula tells. Private.

#include "meso/brep/body.hpp"

namespace meso::brep {

/// Of B-splines, and of points on an axis, the point itself.
[[nodiscard]] Vec3 nearest_point(const Surface& surface, Vec3 p);

}  // namespace meso::brep
