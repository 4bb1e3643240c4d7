// SPDX-License-Identifier: Apache-2.0
#pragma once
// From flags to the options of the operations room.

#include <optional>

#include "meso/operations/convert.hpp"
#include "run.hpp"

namespace meso::cli {

/// Empty: a usage error was reported. Starts the run's limits (see Run::options).
[[nodiscard]] std::optional<operations::MakeOptions> make_options(Run& run);

[[nodiscard]] Json seconds_json(const operations::Seconds& seconds);

}  // namespace meso::cli
