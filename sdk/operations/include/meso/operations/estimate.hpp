// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a document would become, without building it: right within a factor of 1.5.

#include "meso/operations/convert.hpp"

namespace meso::operations {

struct Estimate {
  std::uint64_t placed = 0, kept = 0;
  std::uint64_t faces = 0, triangles = 0;
  std::uint64_t step_bytes = 0, stl_bytes = 0, ascii_stl_bytes = 0;
};

/// Reads the macrostructure, samples where the cells stand, and realises at most a few cells to learn what one costs.
/// Seconds, whatever the number of cells.
[[nodiscard]] std::optional<Estimate> estimate(const std::filesystem::path& document, const MakeOptions& options,
                                               DiagnosticSink& sink);

}  // namespace meso::operations
