// SPDX-License-Identifier: Apache-2.0
#pragma once
// The lattice's tetrahedra, replaced by what of them is inside. Private.

#include "cuts.hpp"

namespace meso::implicit::stuffing {

/// Corners are ids: of a lattice point, or Points::count() plus the number of a cut.
using RawTet = std::array<std::uint32_t, 4>;

/// In the order of the lattice's planes. Nothing: stopped.
[[nodiscard]] std::optional<std::vector<RawTet>> fill(const Points& points, Threads& threads);

/// Points of the lattice come first, then cuts.
struct Numbered {
  TetMesh mesh;              ///< without its boundary
  std::vector<bool> inside;  ///< by point: certainly not on the boundary
};
[[nodiscard]] Numbered number_points(std::vector<RawTet> tets, const Points& points, const std::vector<Cut>& cuts,
                                     const std::vector<Moved>& moved);

void find_boundary(Numbered& numbered, const Box3& box);

}  // namespace meso::implicit::stuffing
