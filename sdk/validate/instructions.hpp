// SPDX-License-Identifier: Apache-2.0
#pragma once
// what a pattern does with each cell.

#include "families.hpp"

namespace meso {

/// `names` is what the pattern's instructions see at first; `cell` is null if the link is broken.
void check_instructions(Context& c, const Pattern& pattern, const UnitCell* cell, Scope& names);

void check_conformal_instruction(Context& c, const Instruction& instruction);

}  // namespace meso
