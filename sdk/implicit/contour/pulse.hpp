// SPDX-License-Identifier: Apache-2.0
#pragma once
// Asks whether to stop, and tells how far the work is: often enough, and from one thread at a time.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string_view>

#include "meso/base/run_options.hpp"

namespace meso::implicit {

class Pulse {
 public:
  /// `steps` beats make a stage.
  Pulse(const RunOptions& run, std::uint64_t steps) : run_(run), steps_(steps) {}

  void begin(std::string_view stage) {
    stage_ = stage;
    done_ = 0;
  }
  /// Any thread; a row's worth of work is done. False: stop.
  [[nodiscard]] bool beat() {
    const std::uint64_t done = done_.fetch_add(1, std::memory_order_relaxed);
    if (done % beats_between_looks == 0) look(done);
    return !stopped();
  }
  /// Within a long row's work. False: stop.
  [[nodiscard]] bool check() {
    look(done_);
    return !stopped();
  }
  void stop() { stopped_ = true; }
  [[nodiscard]] bool stopped() const { return stopped_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool out_of_time() const { return out_of_time_; }

 private:
  static constexpr std::uint64_t beats_between_looks = 16;

  void look(std::uint64_t done) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(20)) return;
    last_ = now;
    run_.report(stage_, std::min(1.0, static_cast<double>(done) / static_cast<double>(steps_)));
    if (run_.out_of_time()) out_of_time_ = true;
    if (out_of_time_ || (run_.cancelled && run_.cancelled())) stopped_ = true;
  }

  const RunOptions& run_;
  std::uint64_t steps_;
  std::string_view stage_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_{};
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> stopped_{false}, out_of_time_{false};
};

}  // namespace meso::implicit
