// SPDX-License-Identifier: Apache-2.0
#pragma once
// Pieces of faces that have no width, taken out of what they bound. Private.
//
// Where two circles touch, a body that cuts the tip between them less than a micrometre from it leaves two edges from
// the tip to one and the same corner, and a piece between them that no program tells from nothing. The two become one.

#include <functional>
#include <optional>

#include "lattice/divided_faces.hpp"

namespace meso::brep {

struct Sliver {
  std::uint32_t piece = 0, beside = 0;  ///< another piece has the edge that goes
  std::size_t kept_edge = 0, edge = 0;  ///< the one that stays, and the one that goes
};

/// A piece between two edges that have the same ends and keep within `width` of each other. `is_taken`: bounds what is
/// left; `is_fixed`: its edges must stay. Empty where it is anything else.
[[nodiscard]] std::optional<Sliver> sliver_of(const DividedFaces& faces, std::uint32_t piece, double width,
                                              const std::function<bool(std::uint32_t)>& is_taken,
                                              const std::function<bool(std::uint32_t)>& is_fixed);

/// The piece beside it has the kept edge afterwards, and no taken one has the other.
void take_out(DividedFaces& faces, const Sliver& sliver);

}  // namespace meso::brep
