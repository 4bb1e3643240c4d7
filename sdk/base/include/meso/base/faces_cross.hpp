// SPDX-License-Identifier: Apache-2.0
#pragma once
// Do two faces of a surface cross each other? For surfaces of any number of faces, whose meeting boxes somebody finds.
//
//   visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) { crosses |= faces_cross(surface, i, k, 1e-9); });

#include "meso/base/polyhedron.hpp"

namespace meso {

/// True if they have more in common than the corners and edges that both name. What is within `tolerance` of the
/// other's plane is in it. REQUIRES: each is a polygon with an area.
[[nodiscard]] bool faces_cross(const Polyhedron& polyhedron, std::size_t f, std::size_t g, double tolerance);

}  // namespace meso
