// SPDX-License-Identifier: Apache-2.0
#pragma once
// What to do about a diagnostic: one or two sentences of the registry, schema/diagnostics.json, for whoever shows
// diagnostics to people. render() leaves them out.

#include <string_view>

#include "meso/base/codes.hpp"

namespace meso {

/// Never empty for a code of the registry.
[[nodiscard]] std::string_view help(Code code);

}  // namespace meso
