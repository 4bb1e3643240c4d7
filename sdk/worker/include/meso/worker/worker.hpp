// SPDX-License-Identifier: Apache-2.0
#pragma once
// Geometry behind a wall: the work is done by the `meso` command in a process of its own, with limits of time and
// memory. Whatever a geometry kernel does there to a foreign file -- hang, crash, take all memory -- is one diagnostic
// here. Callers who would rather work in their own process call meso/operations/convert.hpp instead.
//
//   worker::Options options{.command = "/usr/bin/meso", .run = {.deadline = in_a_minute}};
//   const auto made = worker::convert("part.meso", "part.step", {"--set", "pitch=8mm"}, options, sink);
//   if (made && made->closed) show(made->volume);
//   const auto report = worker::run({"verify", "--deep", "part.meso"}, options, sink);   // JSON, see docs/command.md
//
// Links no geometry kernel. The host keeps its signal handlers, its signal mask and its standard streams. Thread rule:
// any number of calls at once, each waits for its own process.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"

namespace meso::worker {

struct Options {
  std::string command = "meso";  ///< a path, or a name that PATH leads to
  /// The process ends at the deadline, beyond the memory and when `cancelled` says so, within 4 s at worst; files that
  /// it had not finished are removed.
  RunOptions run{};
};

/// `meso WORDS --json` for a verb that takes --timeout: convert, compare, verify, render, sdf, field, eval, info.
/// Returns the JSON object that it prints; nothing where there is an error, which is in `sink` as all its diagnostics
/// are. WORKER_NOT_STARTED where there is no such program, GEOMETRY_CRASHED where it ended without an answer.
[[nodiscard]] std::optional<std::string> run(std::vector<std::string> words, const Options& options,
                                             DiagnosticSink& sink);

/// What convert() made. Millimetres, seconds, bytes.
struct Converted {
  std::string engine, way;
  std::uint64_t solids = 0, faces = 0, triangles = 0, bytes = 0, peak_bytes = 0;
  double volume = 0, area = 0, seconds = 0;
  bool closed = false;
};
/// `meso convert IN OUT FLAGS`.
[[nodiscard]] std::optional<Converted> convert(const std::filesystem::path& in, const std::filesystem::path& out,
                                               const std::vector<std::string>& flags, const Options& options,
                                               DiagnosticSink& sink);

}  // namespace meso::worker
