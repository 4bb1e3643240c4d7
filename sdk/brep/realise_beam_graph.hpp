// SPDX-License-Identifier: Apache-2.0
#pragma once
// The union of beams whose struts all end within the balls of their nodes, whatever their radii and places: graded
// lattices, and trusses that a conformal mapping bends. Private.

#include <optional>

#include "meso/brep/lattice_body.hpp"
#include "meso/eval/evaluation.hpp"
#include "solid_context.hpp"

namespace meso::brep {

struct BeamGraphPart {
  Body body;
  std::uint64_t kept = 0;
};

/// True if the cells are beams, and those are to be tried as a graph.
[[nodiscard]] bool may_be_beam_graph(const eval::CellStream& cells, const SolidContext& context);

/// True if booleans would meet circles that touch, as automatic balls have them: such a lattice is not repeated.
[[nodiscard]] bool has_touching_circles(const eval::CellStream& cells);

/// Do all struts part on the balls of their nodes? True also where there are too many cells to tell at once.
[[nodiscard]] bool struts_part_on_balls(const eval::CellStream& cells, const SolidContext& context);

/// Nothing, and no error in the sink, where struts meet in other ways (GEOMETRY_STRUTS_MEET tells why). May throw
/// Standard_Failure.
[[nodiscard]] std::optional<BeamGraphPart> beam_graph_part(const eval::CellStream& cells, ElementId where,
                                                           const LatticeOptions& options, const SolidContext& context);

/// The same for beams of any origin, in the world.
[[nodiscard]] std::optional<BeamGraphPart> beam_graph_part(const eval::BeamsShape& beams, ElementId where,
                                                           const LatticeOptions& options, const SolidContext& context);

/// The balls and struts of the cells, each once however many cells have it: their union is the body. Nothing, and no
/// error in the sink, where struts end outside of balls. May throw Standard_Failure.
[[nodiscard]] std::optional<Solids> beam_graph_primitives(const eval::CellStream& cells, const SolidContext& context);

}  // namespace meso::brep
