// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lattices whose cell boxes stand side by side. In the aligned case all faces of the macrostructure lie on planes of
// the boxes, and each box is wholly inside or outside; else boxes that the boundary crosses are clipped. Private.

#include <optional>

#include "lattice/cell_selection.hpp"
#include "lattice/clipped_lattice.hpp"
#include "meso/brep/body_sample.hpp"
#include "meso/brep/lattice_body.hpp"
#include "meso/brep/realise.hpp"
#include "meso/eval/evaluation.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Connected solids: a point in each, where that is known, and which one a point is in.
struct ConnectedPieces {
  std::vector<std::optional<Vec3>> points;
  std::function<std::optional<std::size_t>(Vec3)> at;
};

struct LatticePart {
  Body body;
  std::uint64_t kept = 0;
  std::uint64_t crossing = 0;
  ClipCounts clip{};
  std::optional<ConnectedPieces> cut{}, joined{};  ///< before and after bodies are added, where they are asked for
};

/// What becomes of the union of the cells.
struct LatticeRequest {
  Solids clip{};                          ///< what it is cut to; empty: nothing
  Solids removed{};                       ///< where it is not cut to anything: what is taken away
  Solids added{};                         ///< what it is united with after that
  std::optional<CellRule> whole_cells{};  ///< the cells that this takes are not cut; nothing is removed or added
  std::optional<MeshFineness> mesh{};
  PiecesAsked pieces = PiecesAsked::none;  ///< where there is something to cut to, or to add
  FusedLimit fused{};
};

/// (Union of the cells n clip - removed) u added, as one repeated template; or nothing, and no error in the sink, where
/// that is not such a lattice. Errors of evaluation are reported. May throw Standard_Failure.
[[nodiscard]] std::optional<LatticePart> lattice_part(const LatticeRequest& request, const eval::CellStream& cells,
                                                      const SolidContext& context);

/// The largest radius of the first cell's struts, by the longest edge of its box: from 0.5 on, struts of neighbours
/// that are side by side are one. 0 where there are no neighbours, no box or no struts, or where boxes are bent.
struct Thickness {
  double radius = 0, edge = 1;
  double ball = 0;        ///< the largest radius of a ball
  bool is_block = false;  ///< struts thicker than 0.4 of the edge, or balls larger than it, leave nothing of a box open
  [[nodiscard]] double ratio() const { return radius / edge; }
};
[[nodiscard]] Thickness strut_thickness(const eval::CellStream& cells, DiagnosticSink& sink);

/// The same lattice as two small blocks of whole cells, weighted so that cells and walls on the surface add up.
struct LatticeSample {
  std::vector<WeightedBody> bodies;
  std::uint64_t kept = 0;
};
[[nodiscard]] std::optional<LatticeSample> lattice_sample(const Solids& macrostructure, const eval::CellStream& cells,
                                                          const std::optional<MeshFineness>& mesh,
                                                          const SolidContext& context);

}  // namespace meso::brep
