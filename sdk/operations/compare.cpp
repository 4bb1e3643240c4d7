// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/compare.hpp"

#include <set>

#include "meso/base/xml_text.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"
#include "meso/package/open_document.hpp"
#include "meso/package/package.hpp"
#include "meso/package/referenced_files.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

/// Counts what a writer would write.
class CountingSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view bytes) override {
    bytes_ += bytes.size();
    return true;
  }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t bytes_ = 0;
};

std::uint64_t step_bytes(const brep::Body& body) {
  CountingSink count;
  (void)write_step(body, {}, count);
  return count.bytes();
}

std::uint64_t bytes_of(const Resource& resource) {
  std::string error;
  const auto bytes = ResourceBytes::open(resource, error);
  return bytes ? bytes->view().size() : 0;
}

/// The macrostructures alone: imported STEP files as they are, others as the STEP that convert would write.
std::optional<std::uint64_t> macro_bytes(const eval::Evaluation& evaluation, DiagnosticSink& sink) {
  std::uint64_t total = 0;
  for (const Macrostructure& macro : evaluation.document().macrostructures) {
    if (const auto* import = std::get_if<ImportBody>(&macro.body)) {
      total += bytes_of(*evaluation.checked().resources().find(import->href.text));
      continue;
    }
    const auto body = brep::realise_macrostructure(evaluation, macro, {}, sink);
    if (!body) return std::nullopt;
    total += step_bytes(*body);
  }
  return total;
}

}  // namespace

std::optional<ComparisonRow> compare(const fs::path& document, const MakeOptions& options, DiagnosticSink& sink) {
  MakeOptions with_mesh = options;
  with_mesh.mesh = true;
  const auto made = make_body(document, with_mesh, sink);
  if (!made) return std::nullopt;
  ComparisonRow row{.name = document.stem().string(),
                    .cells = made->realisation.cells.kept,
                    .deflection_mm = made->deflection_mm,
                    .angle_rad = made->angle_rad,
                    .seconds = made->seconds};
  const auto macro = macro_bytes(made->evaluation, sink);
  if (!macro) return std::nullopt;
  row.macro_step = *macro;

  Stopwatch watch;
  const brep::Body& body = made->realisation.body;
  row.part_step = step_bytes(body);
  row.seconds.write = watch.lap();
  row.seconds.total += row.seconds.write;
  CountingSink stl;
  row.triangles = write_stl(brep::triangles_of(body), StlFormat::ascii, stl).triangles;
  row.part_stl = stl.bytes();

  const CheckedDocument& checked = made->evaluation.checked();
  row.framework = is_package(document) ? checked.source().text().size() : bytes_of(document);
  std::set<fs::path> files;  // two names may lead to one file
  for (const ReferencedFile& file : referenced_files(checked)) {
    if (files.insert(file.resource.name()).second) row.framework += bytes_of(file.resource);
  }
  const auto packed = packed_size(checked, options.run, sink);
  if (!packed) return std::nullopt;
  row.packed = packed->bytes;
  return row;
}

std::optional<std::string> document_with_parameter(const fs::path& document, const std::string& id,
                                                   const std::string& value, DiagnosticSink& sink) {
  const auto read = open_document(document, {}, sink);
  if (!read) return std::nullopt;
  for (const Parameter& parameter : read->document.parameters) {
    if (parameter.id.text != id) continue;
    const SourceSpan span = read->source.span(parameter.id_in_source, "value");
    std::string text = read->source.text();
    return text.replace(span.offset, span.length, escaped_attribute(value));
  }
  sink.report({.code = Code::usage, .args = {"the document has no parameter '" + id + "'"}});
  return std::nullopt;
}

}  // namespace meso::operations
