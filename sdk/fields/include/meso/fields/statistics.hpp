// SPDX-License-Identifier: Apache-2.0
#pragma once
// Counts and ranges of columns, in one pass.
//
//   const auto all = statistics(records, run);   // nothing: `run` asked to stop
//   (*all)[0].min, (*all)[0].max, (*all)[0].nan, (*all)[0].first_not_finite

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/fields/records.hpp"

namespace meso::fields {

struct ColumnStatistics {
  double min = std::numeric_limits<double>::infinity();  ///< of finite numbers; min > max if there is none
  double max = -std::numeric_limits<double>::infinity();
  std::size_t nan = 0, infinite = 0;
  std::size_t first_not_finite = 0;  ///< row, if nan + infinite > 0
};

[[nodiscard]] std::optional<std::vector<ColumnStatistics>> statistics(const Records& records, const RunOptions& run);

}  // namespace meso::fields
