// SPDX-License-Identifier: Apache-2.0
#pragma once
// A made part against random points that are judged from the document's definitions alone. Private.

#include "meso/brep/measure.hpp"
#include "meso/operations/verify.hpp"

namespace meso::operations {

/// Adds the checks "volume by points" and "points misjudged", or a note where the points tell nothing. False with a
/// diagnostic: evaluation failed, or the run was stopped.
[[nodiscard]] bool check_points(VerifyReport& report, DeepFigures& figures, const Made& made, const Part& part,
                                const DeepCheck& deep, const RunOptions& run, DiagnosticSink& sink);

/// Six digits: enough where a thousandth is in doubt.
[[nodiscard]] std::string rounded(double value);

}  // namespace meso::operations
