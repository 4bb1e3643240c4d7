// SPDX-License-Identifier: Apache-2.0
#pragma once
// Independent pieces of work over some threads. Private.

#include <algorithm>
#include <atomic>
#include <thread>

#include "meso/base/run_options.hpp"
#include "meso/base/threads.hpp"

namespace meso::brep {

/// How many threads `count` pieces of work are worth.
[[nodiscard]] inline std::size_t workers_for(std::size_t count, const RunOptions& run) {
  const std::size_t jobs = run.jobs == 0 ? std::max(1u, std::thread::hardware_concurrency()) : run.jobs;
  return std::min(jobs, count);
}

/// Calls work(worker, index) for every index below `count` in no particular order, until one returns false or the run
/// is to stop. `work` must not throw. False if something was left out.
template <typename Work>
[[nodiscard]] bool in_parallel(std::size_t count, const RunOptions& run, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  const auto loop = [&](std::size_t worker) {
    for (std::size_t i = next++; i < count && !stop; i = next++)
      if (run.should_stop() || !work(worker, i)) stop = true;
  };
  on_threads(workers_for(count, run), loop);
  return !stop;
}

}  // namespace meso::brep
