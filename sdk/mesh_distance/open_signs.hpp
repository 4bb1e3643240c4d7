// SPDX-License-Identifier: Apache-2.0
#pragma once
// Inside and outside of a mesh with holes at the nodes of a grid, by few winding numbers.
//
// Away from the mesh the winding number is harmonic: the surface where it is one half has no part that stands alone,
// each begins at the mesh (maximum principle). So it is evaluated where edges of the grid cross the mesh, and from
// there on wherever neighbours differ, until none do; every other node is like the one before it.

#include <functional>

#include "row_signs.hpp"

namespace meso::implicit {

/// Nodes by tick numbers.
using IsInside = std::function<bool(std::int32_t i, std::int32_t j, std::int32_t k)>;

/// Gives `rows`, made of the same triangles and ticks, the numbers 1 where `is_inside` says so, and 0. Cut short by
/// `stop`, they mean nothing.
void decide_by_winding_number(RowSigns& rows, std::span<const Triangle> triangles, const GridTicks& ticks,
                              const IsInside& is_inside, StopPoll& stop);

}  // namespace meso::implicit
