// SPDX-License-Identifier: Apache-2.0
#pragma once
// A range of values that a field takes in a box: what is outside of it does not occur there.

#include <cmath>

namespace meso::implicit {

/// Closed. `undefined` says that the field may have no value (NaN) somewhere in the box; such points count as outside.
struct Interval {
  double lo = -HUGE_VAL;
  double hi = HUGE_VAL;
  bool undefined = false;

  [[nodiscard]] static Interval everything() { return {-HUGE_VAL, HUGE_VAL, true}; }
  [[nodiscard]] bool contains(double v) const { return std::isnan(v) ? undefined : lo <= v && v <= hi; }
  /// Negative is inside; zero and "no value" are outside.
  [[nodiscard]] bool all_inside() const { return hi < 0 && !undefined; }
  [[nodiscard]] bool all_outside() const { return lo >= 0; }
  friend bool operator==(const Interval&, const Interval&) = default;
};

}  // namespace meso::implicit
