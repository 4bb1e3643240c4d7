// SPDX-License-Identifier: Apache-2.0
#pragma once
// After which length a program's solid repeats, as far as its words tell: tpms and strut after 1, scaled; repeat.
//
//   if (const auto period = shortest_period(program); period && period->length < 4 * spacing) ...   // it is not seen
//
// The shortest of all that the solid is made of. Nothing where no word repeats, or
// behind a bend. Linear in the number of words. Thread rule: pure.

#include <optional>

#include "meso/sdf/program.hpp"

namespace meso::sdf {

struct Period {
  const Instruction* made_by = nullptr;  ///< of the program
  double length = 0;
};

[[nodiscard]] std::optional<Period> shortest_period(const Program& program);

}  // namespace meso::sdf
