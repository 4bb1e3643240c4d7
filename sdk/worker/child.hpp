// SPDX-License-Identifier: Apache-2.0
#pragma once
// A program in a process of its own, heard until it ends.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace meso::worker {

struct ChildEnd {
  int start_error = 0;  ///< errno where it did not start
  int status = 0;       ///< as waitpid() tells it
  std::string output;   ///< all of its standard output
};

/// Runs `words`, the program first. `hear_line`: each line of its standard error. `should_stop` is asked ten times a
/// second; when true the program is asked to end (SIGTERM), and three seconds later it is killed.
[[nodiscard]] ChildEnd run_child(const std::vector<std::string>& words,
                                 const std::function<void(std::string_view)>& hear_line,
                                 const std::function<bool()>& should_stop);

}  // namespace meso::worker
