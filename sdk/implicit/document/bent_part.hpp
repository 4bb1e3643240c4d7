// SPDX-License-Identifier: Apache-2.0
#pragma once
// A part that a conformal mapping bends: each point of the world is asked where it comes from. Private.

#include <optional>

#include "meso/eval/evaluation.hpp"
#include "shape_field.hpp"

namespace meso::implicit {

/// `part`: in the cell's own coordinates. In the world, cut to the box as it is bent: beyond it a point comes from
/// several, so parts that are not cut to their box are refused. Nothing if something was reported. REQUIRES: a
/// conformal cell.
[[nodiscard]] std::optional<Field> bent_part(const eval::CellStream& cells, const eval::PlacedCell& cell,
                                             const Field& part, const Reporter& report);

}  // namespace meso::implicit
