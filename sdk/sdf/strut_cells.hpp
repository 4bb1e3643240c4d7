// SPDX-License-Identifier: Apache-2.0
#pragma once
// The library's cells of struts as endless lattices: what `strut.NAME r` means. Private.

#include <string>
#include <string_view>
#include <vector>

#include "meso/implicit/field.hpp"

namespace meso::sdf {

[[nodiscard]] bool is_strut_cell(std::string_view name);
/// strut.bcc, strut.diamond, ...
[[nodiscard]] std::vector<std::string> strut_words();

/// One cell of edge 1 from the origin, and again at every step of its box: the distance to all struts and balls that
/// reach into a cell or an eighth of its edge beside it. REQUIRES: a name of a cell; a radius below 1/4.
struct StrutLattice {
  implicit::Term term;
  Vec3 period;
};
[[nodiscard]] StrutLattice strut_lattice(std::string_view name, double radius);

}  // namespace meso::sdf
