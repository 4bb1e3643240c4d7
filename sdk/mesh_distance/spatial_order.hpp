// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles in the order of a curve that fills space (Morton 1966), so that neighbours in the list are neighbours.

#include <cstdint>
#include <vector>

#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

/// Place on the curve, and a triangle. Equal triangles have equal places, whatever the order of their corners.
struct Placed {
  std::uint64_t place;
  std::uint32_t triangle;
};

/// Sorted by place, equal ones by number. `box` holds all points.
[[nodiscard]] std::vector<Placed> spatial_order(const TriangleMesh& mesh, const Box3& box);

}  // namespace meso::implicit
