// SPDX-License-Identifier: Apache-2.0
#pragma once
// Counts and ranges of columns, in one pass.
//
//   const std::vector<ColumnStatistics> all = statistics(records);
//   all[0].min, all[0].max, all[0].not_finite, all[0].first_not_finite

#include <cstddef>
#include <limits>
#include <vector>

#include "meso/fields/records.hpp"

namespace meso::fields {

struct ColumnStatistics {
  double min = std::numeric_limits<double>::infinity();  ///< of finite numbers; min > max if there is none
  double max = -std::numeric_limits<double>::infinity();
  std::size_t nan = 0, infinite = 0;
  std::size_t first_not_finite = 0;  ///< row, if nan + infinite > 0
};

[[nodiscard]] std::vector<ColumnStatistics> statistics(const Records& records);

}  // namespace meso::fields
