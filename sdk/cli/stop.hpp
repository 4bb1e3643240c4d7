// SPDX-License-Identifier: Apache-2.0
#pragma once
// SIGINT, SIGTERM and SIGHUP ask the work to stop; if it does not within a second, temporary files are removed and the
// process ends. One that is ignored already (nohup) stays so. An answer that is being given is not cut off but a second
// later, or by a second signal.

#include <csignal>
#include <cstdint>
#include <string>

#include "meso/base/diagnostic.hpp"

namespace meso::cli {

/// SIGINT, SIGTERM and SIGHUP, without those that whoever started us wants ignored, as `nohup` and `&` in a script do.
[[nodiscard]] sigset_t stop_signals();

/// Why the process ends, as far as a reader takes it at once: a pipe that is full keeps nobody.
void tell_last(const Diagnostic& why, bool as_json);

/// Call once, before any other thread starts: blocks these signals everywhere and waits for them in a thread of its
/// own. A file beyond `ulimit -f` is an error of writing from now on, and does not end the process.
void watch_stop_signals();
/// True once a signal has come.
[[nodiscard]] bool stop_requested();
/// The process ends by itself, temporary files removed, `seconds` from now at the latest (a grace second later), with
/// exit code 6.
void end_after(double seconds);

/// Work beyond this much private memory is asked to stop, as by a signal; then memory_ran_out(), and the exit code
/// is 6. Allocations that fail would not do: OpenCASCADE takes them for faults of the geometry.
void end_beyond(std::uint64_t bytes, std::string text);
[[nodiscard]] bool memory_ran_out();

/// A process that has to end by itself says so in an object on standard output, too.
void answer_stop_in_json();
/// Before anything is printed: the answer is the caller's now. True the first time, for whoever prints the one object.
/// Does not return where the process is about to end by itself.
[[nodiscard]] bool claim_answer();

}  // namespace meso::cli
