// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lattices whose cell boxes stand side by side. In the aligned case all faces of the macrostructure lie on planes of
// the boxes, and each box is wholly inside or outside; else boxes that the boundary crosses are clipped. Private.

#include <optional>

#include "lattice/cell_selection.hpp"
#include "meso/brep/body_sample.hpp"
#include "meso/brep/lattice_body.hpp"
#include "meso/brep/realise.hpp"
#include "meso/eval/evaluation.hpp"
#include "solid_context.hpp"

namespace meso::brep {

struct LatticePart {
  Body body;
  std::uint64_t kept = 0;
  std::uint64_t crossing = 0;
  ClipCounts clip{};
};

/// Macrostructure n union of the cells, without a macrostructure the union of the cells, or of those that a boundary
/// rule takes whole; or nothing, and no error in the sink, where that is not such a lattice. Errors of evaluation are
/// reported. May throw Standard_Failure.
[[nodiscard]] std::optional<LatticePart> lattice_part(const Solids& macrostructure, const eval::CellStream& cells,
                                                      const std::optional<CellRule>& whole_cells,
                                                      const std::optional<MeshFineness>& mesh,
                                                      const SolidContext& context);

/// The largest radius of the first cell's struts, by the longest edge of its box: from 0.5 on, struts of neighbours
/// that are side by side are one. 0 where there are no neighbours, no box or no struts, or where boxes are bent.
struct Thickness {
  double radius = 0, edge = 1;
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
