// SPDX-License-Identifier: Apache-2.0
#pragma once
// The distance to an extruded polygon. Private.

#include "meso/eval/shape.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// Exact in the plane of the profile and along z.
[[nodiscard]] Field extrusion(const eval::ExtrusionShape& shape);

}  // namespace meso::implicit
