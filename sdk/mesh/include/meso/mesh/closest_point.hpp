// SPDX-License-Identifier: Apache-2.0
#pragma once
// From p to the nearest point of one triangle, for any three corners: needles, caps, segments and points included.
// Always finite, and p plus the answer is a point of the triangle up to rounding.

#include "meso/base/triangle_stream.hpp"

namespace meso {

[[nodiscard]] Vec3 to_closest_point(const Triangle& t, Vec3 p);

}  // namespace meso
