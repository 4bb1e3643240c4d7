// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the work under way is expected to take, so that a process that ends for want of memory can say how much it
// would have been.
//
//   foresee_memory({.code = Code::limit_tolerance, .args = {...}});  // and anew where more is known
//   ...
//   forget_foreseen_memory();  // it is done
//
// One for the process: the last that was told counts. Thread rule: any thread.

#include <optional>

#include "meso/base/diagnostic.hpp"

namespace meso {

/// `takes` is what to say in place of LIMIT_MEMORY.
void foresee_memory(Diagnostic takes);
void forget_foreseen_memory();
[[nodiscard]] std::optional<Diagnostic> foreseen_memory();

}  // namespace meso
