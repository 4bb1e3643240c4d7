// SPDX-License-Identifier: Apache-2.0
#pragma once
// How thick the walls of a program's solid are, as far as its words tell: that of `shell` about a distance is a length.
//
//   if (const auto wall = thinnest_wall(program); wall && wall->thickness < spacing) ...   // samples miss it
//
// Nothing where no word leaves a wall, or where its field is a level set (tpms, expression, scaled along three axes),
// whose thickness no word tells. Linear in the number of words. Thread rule: pure.

#include <optional>

#include "meso/sdf/program.hpp"

namespace meso::sdf {

struct Wall {
  const Instruction* made_by = nullptr;  ///< of the program
  double thickness = 0;
};

[[nodiscard]] std::optional<Wall> thinnest_wall(const Program& program);

}  // namespace meso::sdf
