// SPDX-License-Identifier: Apache-2.0
#pragma once
// The command language and documents, from file to file (docs/sdf.md, "As a document").
//
//   operations::write_words(program, "part.meso", {}, sink);             // the same design as a document
//   const auto line = operations::print_words("part.meso", {}, sink);    // "tpms.gyroid shell 0.7 -b ... -s 1000000"
//
// Errors: SDF_NOT_A_DOCUMENT, SDF_NOT_WORDS, and those of reading and writing. Thread rule: calls are independent.

#include <optional>
#include <string>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/sdf/program.hpp"

namespace meso::operations {

struct WrittenWords {
  std::size_t parts = 0, unit_cells = 0, bytes = 0;
};
/// To the program's output.
[[nodiscard]] std::optional<WrittenWords> write_words(const sdf::Program& program, ExistingFile existing,
                                                      const RunOptions& run, DiagnosticSink& sink);

[[nodiscard]] std::optional<std::string> print_words(const std::string& document, const RunOptions& run,
                                                     DiagnosticSink& sink);

}  // namespace meso::operations
