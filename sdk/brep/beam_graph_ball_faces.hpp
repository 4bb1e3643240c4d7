// SPDX-License-Identifier: Apache-2.0
#pragma once
// Faces of a ball between loops that are known by points, unit vectors from its centre: a face is on their left.
// Private.

#include <cstddef>
#include <optional>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

using UnitLoop = std::vector<Vec3>;

/// Axes whose poles and seam are off the face and as far from its border as may be: near a pole the curves that readers
/// lay in its angles are off. Nothing where all axes have them on the face. `variant`: other axes for each number.
[[nodiscard]] std::optional<AxisFrame> axes_off(Vec3 centre, const std::vector<UnitLoop>& loops, int variant = 0);

/// Loops that bound one face: from each loop the others are seen on its left, and no other loop parts them.
[[nodiscard]] std::vector<std::vector<std::size_t>> loops_of_faces(const std::vector<UnitLoop>& loops);

}  // namespace meso::brep
