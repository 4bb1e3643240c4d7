// SPDX-License-Identifier: Apache-2.0
#pragma once
// How long work is bounded, watched and stopped, the same in every room.

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>

namespace meso {

/// Budgets have safe defaults; 0 jobs means one per core. Work that would exceed a budget ends with a LIMIT_*
/// diagnostic.
struct RunOptions {
  unsigned jobs = 0;
  std::uint64_t max_cells = 10'000'000;
  std::uint64_t max_memory_bytes = std::uint64_t{4} << 30;
  std::optional<std::chrono::steady_clock::time_point> deadline{};

  /// Called now and then from the working thread; fraction in [0, 1].
  std::function<void(std::string_view stage, double fraction)> progress{};
  /// Polled at least every 0.5 s of work; true asks the work to stop.
  std::function<bool()> cancelled{};

  [[nodiscard]] bool out_of_time() const { return deadline && std::chrono::steady_clock::now() > *deadline; }
  [[nodiscard]] bool should_stop() const { return (cancelled && cancelled()) || out_of_time(); }
  void report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
};

}  // namespace meso
