// SPDX-License-Identifier: Apache-2.0
#pragma once
// RunOptions asked from many threads, one at a time; and as many threads as they grant.

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
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

/// Runs `work` on options.jobs threads. More than there are cores would only earn a warning of TBB's.
template <class Work>
void with_jobs(const RunOptions& options, Work work) {
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(options.jobs == 0 ? cores
                                          : static_cast<int>(std::min<unsigned>(options.jobs, unsigned(cores))));
  arena.execute(work);
}

}  // namespace meso::implicit
