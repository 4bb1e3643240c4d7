// SPDX-License-Identifier: Apache-2.0
#pragma once
// Small bodies that together cost what a document's body would cost, without building that.
//
//   const auto sample = brep::sample_build(*evaluation, {}, {.mesh = true}, sink);
//   double faces = 0;
//   for (const auto& [body, weight] : sample->bodies) faces += weight * face_count(body);
//
// Aligned lattices are two small blocks, whose counts follow the numbers of cells and of walls on the surface exactly.
// Everything else is the macrostructure and a few whole cells: what touches or is cut is counted as if it were not, so
// general booleans come out too large. Weights may be negative. Cells beyond a thousand are sampled evenly, at ordinals
// that depend on nothing but their number. Cost: that of building a few cells, whatever their number. Errors as
// realise_build.

#include <optional>
#include <string_view>
#include <vector>

#include "meso/brep/realise.hpp"

namespace meso::brep {

struct WeightedBody {
  Body body;
  double weight = 1;
};

struct BodySample {
  CellCounts cells;
  std::vector<WeightedBody> bodies;
};

/// What realise_build would make; `run.max_cells` and `max_boolean_solids` do not apply.
[[nodiscard]] std::optional<BodySample> sample_build(const eval::Evaluation& evaluation,
                                                     std::optional<std::string_view> part_id,
                                                     const RealiseOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
