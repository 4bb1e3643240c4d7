// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the surface meets the box: the lattice cuts off the rim there, by up to a cell. Private.

#include "fill.hpp"
#include "meso/implicit/threads.hpp"

namespace meso::implicit::stuffing {

/// Moves points of the boundary onto the rim, as far as all tetrahedra keep the bounds of their angles. Call before
/// find_boundary(). False: stopped.
[[nodiscard]] bool move_to_rims(Numbered& numbered, const BccLattice& lattice, const GridSource& source,
                                Threads& threads);

}  // namespace meso::implicit::stuffing
