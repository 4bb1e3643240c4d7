// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/estimate.hpp"

namespace meso::operations {

std::optional<Estimate> estimate(const std::filesystem::path&, const MakeOptions&, DiagnosticSink&) {
  return std::nullopt;
}

}  // namespace meso::operations
