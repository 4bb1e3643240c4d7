// SPDX-License-Identifier: Apache-2.0
#pragma once
// Conformal mapping: fractions of the cell's box to [q, q + step] of the system's first three axes.

#include "meso/eval/evaluation.hpp"
#include "scope.hpp"

namespace meso::eval {

/// Where p, in cell coordinates, ends up in the world. Millimetres.
[[nodiscard]] Vec3 map_point(const CoordinateFrame& frame_mm, const PlacedCell& cell, const BoxShape& box, Vec3 p);

/// Boxes and booleans of boxes become volume elements; anything else is reported as not realised.
[[nodiscard]] std::optional<Shape> map_shape(const std::shared_ptr<const CoordinateFrame>& frame_mm,
                                             const PlacedCell& cell, const BoxShape& box, const Shape& shape,
                                             const Report& report);

}  // namespace meso::eval
