// SPDX-License-Identifier: Apache-2.0
#include "validator.hpp"

#include <utility>

#include "families.hpp"
#include "meso/validate/validate.hpp"

namespace meso {

std::optional<CheckedDocument> Validator::run(Document document, SourceMap source,
                                              std::shared_ptr<const Resources> resources, DiagnosticSink& sink) {
  const std::size_t errors_before = sink.error_count();
  Context c(document, source, *resources, sink);
  collect_ids(c);
  fill_library_cells(c, document);
  check_links(c);
  check_cycles(c);
  check_parameters(c);
  check_dimensions(c);
  check_coordinate_systems(c);
  check_macrostructures(c);
  check_unit_cells(c);
  check_fields(c);
  check_patterns(c);
  check_parts(c);
  if (sink.error_count() != errors_before) return std::nullopt;
  return CheckedDocument(std::make_shared<const Document>(std::move(document)),
                         std::make_shared<const SourceMap>(std::move(source)), std::move(resources));
}

std::optional<CheckedDocument> validate(Document document, SourceMap source, std::shared_ptr<const Resources> resources,
                                        DiagnosticSink& sink) {
  return Validator::run(std::move(document), std::move(source), std::move(resources), sink);
}

std::optional<CheckedDocument> validate(Document document, SourceMap source, const std::filesystem::path& folder,
                                        DiagnosticSink& sink) {
  return Validator::run(std::move(document), std::move(source), resources_in_folder(folder), sink);
}

}  // namespace meso
