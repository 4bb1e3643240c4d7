// SPDX-License-Identifier: Apache-2.0
#pragma once
// The point of a surface that is nearest to a point, where a formula tells. Private.

#include "meso/brep/body.hpp"

namespace meso::brep {

/// Where several are nearest, as to a centre or an axis, one of them. Of B-splines the point itself.
[[nodiscard]] Vec3 nearest_point(const Surface& surface, Vec3 p);

}  // namespace meso::brep
