// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which parts are built, and on which grid the implicit engine samples them. Private.

#include <vector>

#include "meso/implicit/grid.hpp"
#include "meso/operations/convert.hpp"

namespace meso::operations {

struct PlacedPart {
  const Part* part = nullptr;
  std::optional<Placement> placement;
};

/// What `build` lists; with `part_id` that part alone; without a build the only part. Empty if something was reported.
[[nodiscard]] std::vector<PlacedPart> built_parts(const eval::Evaluation& evaluation, const std::string& part_id,
                                                  DiagnosticSink& sink);

/// The spacing or the samples that are asked for, else those of the document's <mesh>, else a fifth of the smallest
/// feature, but no more than most_default_samples. The box is the <mesh>'s, else `bounds`.
[[nodiscard]] std::optional<implicit::Grid> mesh_grid(const eval::Evaluation& evaluation, const MakeOptions& options,
                                                      const Box3& bounds, double smallest_feature_mm,
                                                      DiagnosticSink& sink);

/// What was told of a grid, with the place where the document says how fine it is; of others, with the document's name.
void pass_on_of_grid(const DiagnosticSink& told, const eval::Evaluation& evaluation, const MakeOptions& options,
                     DiagnosticSink& sink);

/// Whether that part's <mesh>, or the build's, says how many samples.
[[nodiscard]] bool states_samples(const Document& document, const std::string& part_id);

inline constexpr double features_per_sample = 5, most_default_samples = 1e9;

}  // namespace meso::operations
