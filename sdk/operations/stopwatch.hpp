// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <utility>

namespace meso::operations {

/// Wall-clock seconds.
class Stopwatch {
 public:
  /// Since the last lap.
  double lap() {
    const auto now = Clock::now();
    return seconds(now - std::exchange(lap_, now));
  }
  [[nodiscard]] double total() const { return seconds(Clock::now() - start_); }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }
  Clock::time_point start_ = Clock::now();
  Clock::time_point lap_ = start_;
};

}  // namespace meso::operations
