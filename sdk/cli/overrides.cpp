// SPDX-License-Identifier: Apache-2.0
#include "overrides.hpp"

namespace meso::cli {

bool parse_overrides(Run& run, std::vector<eval::Override>& overrides) {
  for (const std::string& text : run.flags.set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      run.usage_error("--set: '" + text + "' is not ID=EXPR, e.g. pitch=8mm");
      return false;
    }
    overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return true;
}

}  // namespace meso::cli
