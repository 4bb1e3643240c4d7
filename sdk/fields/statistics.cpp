// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace meso::fields {

std::optional<std::vector<ColumnStatistics>> statistics(const Records& records, const RunOptions& run) {
  std::vector<ColumnStatistics> result(records.columns());
  constexpr std::size_t poll_mask = 0xFFFF;
  for (std::size_t row = 0; row < records.rows(); ++row) {
    if ((row & poll_mask) == 0 && run.should_stop()) return std::nullopt;
    for (std::size_t c = 0; c < result.size(); ++c) {
      const double value = records(row, c);
      ColumnStatistics& s = result[c];
      if (std::isfinite(value)) {
        s.min = std::min(s.min, value);
        s.max = std::max(s.max, value);
        continue;
      }
      if (s.nan + s.infinite == 0) s.first_not_finite = row;
      ++(std::isnan(value) ? s.nan : s.infinite);
    }
  }
  return result;
}

}  // namespace meso::fields
