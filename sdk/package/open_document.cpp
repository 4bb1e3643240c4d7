// SPDX-License-Identifier: Apache-2.0
#include "meso/package/open_document.hpp"

#include <algorithm>

#include "meso/package/package.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso {
namespace {

std::optional<OpenedDocument> with(std::optional<ReadResult> read, std::shared_ptr<const Resources> resources) {
  if (!read) return std::nullopt;
  return OpenedDocument{std::move(read->document), std::move(read->source), std::move(resources)};
}

std::optional<OpenedDocument> open_package([[maybe_unused]] const std::filesystem::path& file,
                                           [[maybe_unused]] const RunOptions& run, DiagnosticSink& sink) {
#ifdef MESO_WITH_PACKAGES
  const auto package = Package::read(file, run, sink);
  if (!package) return std::nullopt;
  const std::string& name = package->document();
  return with(read_document(*package->entries().at(name), (file / name).string(), sink), package);
#else
  sink.report({.code = Code::package_not_built, .args = {file.string()}});
  return std::nullopt;
#endif
}

}  // namespace

bool is_package(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return extension == ".mesoz";
}

std::optional<OpenedDocument> open_document(const std::filesystem::path& file, const RunOptions& run,
                                            DiagnosticSink& sink) {
  if (is_package(file)) return open_package(file, run, sink);
  return with(read_document_file(file, sink), resources_in_folder(file.parent_path()));
}

std::optional<Resource> open_resource(const std::filesystem::path& file, [[maybe_unused]] const RunOptions& run,
                                      DiagnosticSink& sink) {
  std::filesystem::path container;
  for (const auto& step : file) {
    container /= step;
    std::error_code error;
    if (container == file || !is_package(container) || !std::filesystem::is_regular_file(container, error)) continue;
#ifdef MESO_WITH_PACKAGES
    const auto package = Package::read(container, run, sink);
    if (!package) return std::nullopt;
    const std::string name = file.lexically_relative(container).generic_string();
    auto found = package->find(name);
    if (!found) sink.report({.code = Code::href_outside, .where = {.file = container.string()}, .args = {name}});
    return found;
#else
    sink.report({.code = Code::package_not_built, .args = {container.string()}});
    return std::nullopt;
#endif
  }
  return Resource(file);
}

std::optional<CheckedDocument> open_checked_document(const std::filesystem::path& file, const RunOptions& run,
                                                     DiagnosticSink& sink) {
  auto opened = open_document(file, run, sink);
  if (!opened) return std::nullopt;
  return validate(std::move(opened->document), std::move(opened->source), std::move(opened->resources), sink);
}

}  // namespace meso
