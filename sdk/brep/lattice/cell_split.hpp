// SPDX-License-Identifier: Apache-2.0
#pragma once
// The faces of a closed solid and the faces of a body near it, divided along each other and put together to what the
// solid and the body have in common. Private.
//
// Only faces that come near the body are intersected, all others are inside or outside as a whole: no solid is ever
// built by OpenCASCADE. Faces that hang together without crossing the body's surface are on one side of it, and one
// point says on which. What tells a wrong answer: the pieces of every face have its area and its share of the volume;
// each edge of the result is used once in each direction; the faces of the result, as vectors, add up to nothing;
// corners of whole faces are all on the side of their piece.
//
// Thread rule: one for each thread.

#include <string>

#include "lattice/divided_faces.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

struct ClippedCell {
  enum class Left : std::uint8_t { nothing, all, part };
  Left left = Left::nothing;
  TopoDS_Shape solid;  ///< where a part is left: a compound of solids
  std::string fault;   ///< why there is none
  std::size_t attempts = 1;
  double edge_tolerance = 0;  ///< largest of the part's edges and corners, in millimetres
};

/// May throw Standard_Failure.
[[nodiscard]] ClippedCell split_cell(WholeCell& cell, const LocalBody& body, const SplitOptions& options,
                                     const RunOptions& run);

}  // namespace meso::brep
