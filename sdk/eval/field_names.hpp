// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which quantities of its fields a pattern names: only these are worth computing.

#include <set>
#include <string>

#include "pattern_program.hpp"

namespace meso::eval {

/// Every "field.quantity" in the expressions of the pattern and of its cell.
[[nodiscard]] std::set<std::string> named_quantities(const Pattern& pattern, const UnitCell& cell);

/// Slots for those of the field, known to `scope` from here on.
[[nodiscard]] std::vector<QuantitySlot> define_quantities(PatternProgram& program, Scope& scope,
                                                          const VectorField& field, int level);

}  // namespace meso::eval
