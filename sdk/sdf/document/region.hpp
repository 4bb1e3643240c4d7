// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a solid is looked at, before it is moved. Private.

#include "meso/base/vec.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// A box around all points that the word brings into `region`. REQUIRES: move, scale, rotate, orient or mirror.
[[nodiscard]] Box3 before(const Instruction& instruction, const Box3& region);
/// Rounded outwards, with room to spare: nothing is cut there.
[[nodiscard]] Box3 with_room(const Box3& region);
[[nodiscard]] bool holds(const Box3& outer, const Box3& inner);

}  // namespace meso::sdf
