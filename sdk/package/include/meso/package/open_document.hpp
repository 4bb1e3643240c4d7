// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one way from a file name to a document: .meso in its folder, or .mesoz with everything in it.
//
//   if (auto checked = open_checked_document("beam.mesoz", run, sink)) evaluate(*checked);
//
// A package is read into memory and checked as a whole (package.hpp); nothing is written to disk. Errors: those of
// reading and validation, PACKAGE_*.

#include <filesystem>
#include <memory>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/checked_document.hpp"

namespace meso {

struct OpenedDocument {
  Document document;
  SourceMap source;
  std::shared_ptr<const Resources> resources;
};

/// By its extension, .mesoz.
[[nodiscard]] bool is_package(const std::filesystem::path& file);

[[nodiscard]] std::optional<OpenedDocument> open_document(const std::filesystem::path& file, const RunOptions& run,
                                                          DiagnosticSink& sink);
/// A file of the file system, or of a package: "beam.mesoz/stress.h5". Reads the package.
[[nodiscard]] std::optional<Resource> open_resource(const std::filesystem::path& file, const RunOptions& run,
                                                    DiagnosticSink& sink);
/// The same as open_document, validated.
[[nodiscard]] std::optional<CheckedDocument> open_checked_document(const std::filesystem::path& file,
                                                                   const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso
