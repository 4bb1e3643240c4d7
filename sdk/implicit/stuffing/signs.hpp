// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which points of the lattice are inside. Private.

#include "lattice.hpp"
#include "meso/implicit/threads.hpp"

namespace meso::implicit::stuffing {

/// Points in the box's planes that the solid holds are on the surface; all others in or beyond them are outside. Edges
/// that cross the surface are marked. False: stopped.
[[nodiscard]] bool sample_signs(Points& points, const GridSource& corners, const GridSource& centres, Threads& threads);

}  // namespace meso::implicit::stuffing
