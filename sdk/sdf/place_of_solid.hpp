// SPDX-License-Identifier: Apache-2.0
#pragma once
// Words that move, bend or repeat a solid, as maps of the point.

#include <array>

#include "meso/implicit/term.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// Where the solid's point stands that is seen at (x, y, z). REQUIRES: cylindrical, spherical, helix or repeat.
[[nodiscard]] std::array<implicit::Term, 3> bent(const Instruction& instruction);
/// The same for every word; the point itself where a word moves nothing.
[[nodiscard]] std::array<implicit::Term, 3> place_of_solid(const Instruction& instruction);

}  // namespace meso::sdf
