// SPDX-License-Identifier: Apache-2.0
#pragma once
// SIGINT and SIGTERM ask the work to stop; if it does not within a second, temporary files are removed and the process
// ends.

#include <filesystem>

namespace meso::cli {

/// Call once, before any other thread starts: blocks both signals everywhere and waits for them in a thread of its own.
void watch_stop_signals();
/// True once a signal has come.
[[nodiscard]] bool stop_requested();
/// The process ends by itself, temporary files removed, `seconds` from now at the latest (a grace second later), with
/// exit code 6.
void end_after(double seconds);

/// Unfinished output files beside `output` are removed when the process has to end by itself.
void clean_on_stop(const std::filesystem::path& output);

}  // namespace meso::cli
