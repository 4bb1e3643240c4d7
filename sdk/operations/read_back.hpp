// SPDX-License-Identifier: Apache-2.0
#pragma once
// What OpenCASCADE makes of the STEP file that would be written of a body. Private.

#include <optional>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/brep/body.hpp"

namespace meso::operations {

/// Both in memory. Empty with a diagnostic if it is not read as closed solids. Cost: about
/// 1 ms a face up to 5 000, and growing with the square beyond.
[[nodiscard]] std::optional<brep::Body> read_back(const brep::Body& body, const RunOptions& run, DiagnosticSink& sink);

/// Of each shell, voids negative; in the order of their size.
[[nodiscard]] std::vector<double> shell_volumes(const brep::Body& body);

}  // namespace meso::operations
