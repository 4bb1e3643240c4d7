// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which shares and weights of a program leave 0 ... 1, where they are taken as the nearest of the two.
//
//   for (const Clamped& c : clamped_values(program, box)) ...   // of `tpms.gyroid density '0.5 + x'`, -b
//   -1,-1,-1,1,1,1: c.least == -0.5, c.most == 1.5, c.part is about a half
//
// Looked at are 33 points along each side of the box, through all words that move or bend what lies below; a solid that
// stands in several places is looked at in one of them. Linear in the number of words. Thread rule: pure.

#include <span>
#include <vector>

#include "meso/sdf/program.hpp"

namespace meso::sdf {

struct Clamped {
  const Instruction* made_by = nullptr;  ///< `density` or `blend`, of the program
  double least = 0, most = 0;            ///< that the formula reaches in the box
  double part = 0;                       ///< of the box in which it leaves 0 ... 1
};

/// In the order of the words.
[[nodiscard]] std::vector<Clamped> clamped_values(const Program& program, const Box3& box);

/// A warning for each: SDF_CLAMPED.
void report_clamped(std::span<const Clamped> clamped, DiagnosticSink& sink);

}  // namespace meso::sdf
