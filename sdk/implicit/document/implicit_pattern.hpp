// SPDX-License-Identifier: Apache-2.0
#pragma once
// The cells of a pattern with an implicit body as one field. Private.

#include "pattern_field.hpp"

namespace meso::implicit {

/// REQUIRES: a stream of cells with an implicit body.
[[nodiscard]] std::optional<PatternField> implicit_pattern(const eval::Evaluation& evaluation,
                                                           const eval::CellStream& cells, const KeepCell& keep,
                                                           const RunOptions& run, const Reporter& report);
/// One cell alone, in the world.
[[nodiscard]] std::optional<Field> implicit_cell(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                                 const eval::PlacedCell& cell, const Reporter& report);

}  // namespace meso::implicit
