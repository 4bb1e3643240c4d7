// SPDX-License-Identifier: Apache-2.0
#pragma once
// RunOptions asked from many threads, one at a time.

#include <atomic>
#include <mutex>

#include "meso/base/run_options.hpp"

namespace meso::implicit {

class StopPoll {
 public:
  explicit StopPoll(const RunOptions& options) : options_(options) {}

  /// True from the moment somebody asked to stop.
  [[nodiscard]] bool operator()() {
    if (const std::unique_lock lock(mutex_, std::try_to_lock); lock && options_.should_stop()) stopped_ = true;
    return stopped_;
  }
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  const RunOptions& options_;
  std::mutex mutex_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace meso::implicit
