// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "meso/eval/evaluation.hpp"
#include "run.hpp"

namespace meso::cli {

/// --set texts as overrides. False: a usage error was reported.
[[nodiscard]] bool parse_overrides(Run& run, std::vector<eval::Override>& overrides);

}  // namespace meso::cli
