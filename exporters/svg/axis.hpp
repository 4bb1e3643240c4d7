// SPDX-License-Identifier: Apache-2.0
#pragma once
// An axis of a plot: a range with round ends, and the ticks a reader expects on it.

#include <string>
#include <vector>

namespace meso {

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a minor tick
};

struct Axis {
  bool log = false;
  double low = 0, high = 1;
  std::vector<Tick> ticks;  ///< ascending

  /// 0 at `low`, 1 at `high`.
  [[nodiscard]] double fraction(double value) const;
};

/// The axis that shows [min, max]; with `log`, min > 0.
[[nodiscard]] Axis axis_for(double min, double max, bool log);

/// A number as ticks write it: 0.25, 500, 20k, 1M, 3G.
[[nodiscard]] std::string tick_label(double value);

}  // namespace meso
