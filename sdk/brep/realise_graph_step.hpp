// SPDX-License-Identifier: Apache-2.0
#pragma once
// A step of a part whose cells are beams and whose body is there already: all beams are put together as one graph, and
// one boolean cuts, joins or subtracts that. Private.
//
// Such a boolean takes about 10 ms for each face of the graph, whatever the struts' radii are. Cells joined one by one
// take half a second each, and booleans of struts that nearly touch fail.

#include <optional>
#include <string>

#include "lattice/clipped_lattice.hpp"
#include "meso/eval/evaluation.hpp"
#include "realise_fold.hpp"

namespace meso::brep {

/// About two minutes of a processor.
inline constexpr std::size_t most_graph_faces = 12'000;
inline constexpr double seconds_a_graph_face = 0.01;

/// Beams that are clipped, whatever the operation.
[[nodiscard]] bool may_be_graph_step(const Solids& body, const eval::CellStream& cells, const FoldContext& context);

struct GraphStep {
  std::optional<FoldStep> step;
  std::string why_not{};                     ///< where there is no step and no error in the sink
  std::optional<FusedLimit> may_be_fused{};  ///< boxes of cells that differ, where those are tried next
  bool may_be_joined = false;                ///< and all cells by booleans after that
};

/// Counts are added where there is a step. May throw Standard_Failure.
[[nodiscard]] GraphStep apply_graph(const Solids& body, const eval::CellStream& cells, const FoldContext& context,
                                    CellCounts& counts);

}  // namespace meso::brep
