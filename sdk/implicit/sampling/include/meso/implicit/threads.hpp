// SPDX-License-Identifier: Apache-2.0
#pragma once
// Independent pieces of work on the threads that were asked for, until somebody says stop.

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"

namespace meso::implicit {

class Threads {
 public:
  explicit Threads(const RunOptions& run) : run_(run), arena_(threads(run.jobs)) {}

  /// do_range(first, last) for ranges of at most `grain` that make up [0, count). False: stopped.
  template <class Work>
  bool ranges(std::string_view stage, std::size_t count, std::size_t grain, const Work& do_range) {
    const std::size_t pieces = (count + grain - 1) / grain;
    std::atomic<std::size_t> done{0};
    arena_.execute([&] {
      tbb::parallel_for(
          std::size_t{0}, pieces,
          [&](std::size_t piece) {
            if (stopped_) return;
            do_range(piece * grain, std::min(count, (piece + 1) * grain));
            look(stage, static_cast<double>(++done) / static_cast<double>(pieces));
          },
          tbb::simple_partitioner{});
    });
    return !stopped_;
  }

  /// Between steps of one thread. False: stop.
  [[nodiscard]] bool go_on() {
    if (run_.should_stop()) stopped_ = true;
    return !stopped_;
  }
  void report_stop(DiagnosticSink& sink) const {
    sink.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
  }

 private:
  // No more than TBB has: it would say so on standard error.
  static int threads(unsigned jobs) {
    const std::size_t most = tbb::global_control::active_value(tbb::global_control::parameter::max_allowed_parallelism);
    return static_cast<int>(jobs == 0 ? most : std::min<std::size_t>(jobs, most));
  }
  void look(std::string_view stage, double fraction) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(20)) return;
    last_ = now;
    run_.report(stage, fraction);
    if (run_.should_stop()) stopped_ = true;
  }

  const RunOptions& run_;
  tbb::task_arena arena_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_{};
  std::atomic<bool> stopped_{false};
};

}  // namespace meso::implicit
