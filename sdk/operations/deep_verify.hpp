// SPDX-License-Identifier: Apache-2.0
#pragma once
// A realised part against everything that can judge it. Private.

#include "meso/operations/verify.hpp"

namespace meso::operations {

/// Adds the checks of `verify` with `deep`. `made` is the part alone, meshed. False: stopped or not evaluated,
/// reported.
[[nodiscard]] bool check_deep(VerifyReport& report, const Made& made, const Part& part, const DeepCheck& deep,
                              const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::operations
