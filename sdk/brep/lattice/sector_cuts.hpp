// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where circles in a sector of a ball touch its border or each other, or nearly do, the sector is divided. Private.
//
// As beam_graph_cuts.hpp does for balls that no side of a box cuts: faces that nearly meet themselves are read wrongly.
// A cut alone, or a point of contact, would leave a face that passes it twice; it comes with others that close a ring.

#include <array>
#include <cstdint>
#include <vector>

#include "beam_graph_cuts.hpp"

namespace meso::brep {

enum class Border : std::uint8_t {
  as_it_is,
  linked  ///< by a cut or contact, if there are circles within it, however far away: no axis is off half a ball
};

/// `is_on_border`, by cap: it is a side, or crosses one; these hang together. Cuts as in BallCuts, between caps.
[[nodiscard]] std::vector<BallCuts::Cut> sector_cuts(const std::vector<BallCap>& caps,
                                                     const std::vector<bool>& is_on_border,
                                                     Border border = Border::as_it_is);

}  // namespace meso::brep
