// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles, segments and planes against an axis-parallel box. Private.

#include <array>
#include <optional>
#include <utility>

#include "meso/base/vec.hpp"

namespace meso::brep {

using Triangle3 = std::array<Vec3, 3>;

/// By the thirteen separating axes (Akenine-Moller 2001). Touching counts.
[[nodiscard]] bool overlaps(const Triangle3& triangle, Vec3 centre, Vec3 half);

/// Distance from the plane normal . p = offset to the box's centre, less the box's reach along the unit normal:
/// negative where the plane passes through the box.
[[nodiscard]] double plane_gap(Vec3 normal, double offset, Vec3 centre, Vec3 half);

/// The part of a segment within the box.
[[nodiscard]] std::optional<std::pair<Vec3, Vec3>> clipped(Vec3 from, Vec3 to, Vec3 centre, Vec3 half);

}  // namespace meso::brep
