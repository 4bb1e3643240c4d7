// SPDX-License-Identifier: Apache-2.0
#pragma once
// A program of the command language as a document, and back.
//
//   const auto document = sdf::document_of(*program, box, sink);  // cells, patterns and a part
//   sdf::WhyNot why;
//   const auto again = sdf::program_of(evaluation, "", why);  // the same field, box and samples, to the bit
//   print(sdf::command_line(*again));
//
// What a document says is less than what words say (docs/sdf.md, "As a document"); the others are SDF_NOT_A_DOCUMENT,
// which names the word. A document is words if its one built part states samples and bounds, and is made as
// document_of() makes it; its numbers, and the order of its elements, may differ. Millimetres. Thread rule: pure.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "meso/model/document.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// `box`: what is contoured, as box_of() tells. Meshes are referred to from `folder`, where the document will be.
[[nodiscard]] std::optional<Document> document_of(const Program& program, const Box3& box,
                                                  const std::filesystem::path& folder, DiagnosticSink& sink);

struct WhyNot {
  std::string element, why;
};
/// Of the part, or of the one that is built if `part` is empty. Paths of meshes as they are opened.
[[nodiscard]] std::optional<Program> program_of(const eval::Evaluation& evaluation, const std::string& part,
                                                WhyNot& why);

/// All that stands in the way of program_of(), one for each step and cell. It looks at all of the document.
[[nodiscard]] std::vector<WhyNot> all_that_is_no_word(const eval::Evaluation& evaluation, const std::string& part);

/// Behind `meso sdf`: words a shell splits as they are, numbers in full.
[[nodiscard]] std::string command_line(const Program& program);

}  // namespace meso::sdf
