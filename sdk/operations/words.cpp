// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/words.hpp"

#include <filesystem>

#include "meso/operations/sdf.hpp"
#include "meso/package/open_document.hpp"
#include "meso/sdf_document/words_and_documents.hpp"
#include "meso/xml/write.hpp"

namespace meso::operations {

std::optional<WrittenWords> write_words(const sdf::Program& program, ExistingFile existing, const RunOptions& run,
                                        DiagnosticSink& sink) {
  const auto box = sdf_box(program, run, sink);
  if (!box) return std::nullopt;
  const auto folder = std::filesystem::path(program.output).parent_path();
  const auto document = sdf::document_of(program, *box, folder, sink);
  auto file = document ? OutputFile::create(program.output, existing, sink) : std::nullopt;
  if (!file) return std::nullopt;
  const std::string text = meso::write_document(*document);
  if (!file->write(text) || !file->commit(sink)) return std::nullopt;
  return WrittenWords{
      .parts = document->parts.items.size(), .unit_cells = document->unit_cells.items.size(), .bytes = text.size()};
}

std::optional<std::string> print_words(const std::string& document, const RunOptions& run, DiagnosticSink& sink) {
  const auto checked = open_checked_document(document, run, sink);
  const auto evaluation = checked ? eval::Evaluation::make(*checked, {.run = run}, sink) : std::nullopt;
  if (!evaluation) return std::nullopt;
  sdf::WhyNot why;
  if (const auto program = sdf::program_of(*evaluation, "", why)) return sdf::command_line(*program);
  for (const sdf::WhyNot& each : sdf::all_that_is_no_word(*evaluation, ""))
    sink.report({.code = Code::sdf_not_words, .args = {each.element, each.why}});
  return std::nullopt;
}

}  // namespace meso::operations
