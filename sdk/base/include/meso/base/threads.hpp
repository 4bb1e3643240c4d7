// SPDX-License-Identifier: Apache-2.0
#pragma once
// One piece of work on several threads.
//
//   on_threads(4, [&](std::size_t worker) { ... });   // worker 0 is the caller; returns when all are done
//
// Where the system refuses a thread (a limit on memory or on processes) there are fewer, so what each one does must not
// depend on how many there are. `work` must not throw.

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace meso {

template <typename Work>
void on_threads(std::size_t threads, const Work& work) {
  std::vector<std::jthread> others;
  try {
    for (std::size_t worker = 1; worker < threads; ++worker) others.emplace_back(work, worker);
  } catch (const std::system_error&) {
  }
  work(std::size_t{0});
}

}  // namespace meso
