// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bytes to Document: well-formedness, schema and source places. Meaning is the business of validate.
//
//   DiagnosticSink sink;
//   if (auto read = read_document_file("beam.meso", sink)) use(read->document);
//
// Never throws for input; time and memory are linear in the input. All independent faults are reported in one run.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/model/document.hpp"
#include "meso/model/source_map.hpp"

namespace meso {

/// Limits, each answered by a diagnostic of its own. Memory is at most about 20 bytes per byte of the file.
struct ReadOptions {
  static constexpr std::size_t deepest = 1000;  ///< what max_depth is cut to: reading recurses once per level
  std::size_t max_bytes = std::size_t{256} << 20;
  std::size_t max_depth = 100;
  std::size_t max_nodes = 5'000'000;      ///< elements and attributes together
  std::vector<std::string> understood{};  ///< names that `requires` may ask for beyond what this reader knows
};
struct ReadResult {
  Document document;
  SourceMap source;
};

/// `bytes` in UTF-8 or (with byte order mark) UTF-16; `file` is the name diagnostics show.
[[nodiscard]] std::optional<ReadResult> read_document(std::string bytes, std::string file, DiagnosticSink& sink,
                                                      const ReadOptions& options = {});
[[nodiscard]] std::optional<ReadResult> read_document_file(const std::filesystem::path& file, DiagnosticSink& sink,
                                                           const ReadOptions& options = {});

}  // namespace meso
