// SPDX-License-Identifier: Apache-2.0
#pragma once
// Loops, list and fill as loops over slots.

#include "pattern_program.hpp"

namespace meso::eval {

/// Number of indices of a cell: one per loop or fill range, one for a list.
[[nodiscard]] std::size_t generator_loops(const Pattern& pattern);

/// Fills in the loops; afterwards `scope` knows the indices, the axes and global.x y z.
[[nodiscard]] bool compile_generator(PatternProgram& program, Scope& scope, const Report& report);

/// Reads the field of the pattern's scatter; afterwards `scope` knows what the pattern names of it.
[[nodiscard]] std::optional<ScatterRecords> compile_scatter(PatternProgram& program, Scope& scope,
                                                            const Report& report);

}  // namespace meso::eval
