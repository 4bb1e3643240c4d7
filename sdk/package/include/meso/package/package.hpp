// SPDX-License-Identifier: Apache-2.0
#pragma once
// Packages (.mesoz): a document and all its files in one ZIP, with their SHA-256 sums. docs/specification/package.md.
//
//   if (auto package = Package::read("beam.mesoz", run, sink)) package->find("beam.step");   // bytes in memory
//   pack("beam.meso", "beam.mesoz", {}, sink);
//   unpack("beam.mesoz", "folder", {}, sink);
//
// Reading inflates every entry into memory, checks its CRC, its name and its sum, and refuses the package as a whole at
// the first fault: nothing of a bad package is used. More than RunOptions::max_memory_bytes are refused before the
// first byte is inflated. Deterministic: one build gives equal packages of equal files. Thread rule: a Package is
// immutable.

#include <cstdint>
#include <map>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/checked_document.hpp"

namespace meso {

class Package final : public Resources {
 public:
  /// Null after a report: PACKAGE_*, FILE_NOT_FOUND, LIMIT_TIME, CANCELLED.
  [[nodiscard]] static std::shared_ptr<const Package> read(const std::filesystem::path& file, const RunOptions& run,
                                                           DiagnosticSink& sink);

  /// By an href of the document; a file that is not in the package is a resource that does not exist.
  [[nodiscard]] std::optional<Resource> find(std::string_view href) const override;
  /// Name of the entry that is the document.
  [[nodiscard]] const std::string& document() const { return document_; }

  using Entries = std::map<std::string, std::shared_ptr<const std::string>>;
  /// All entries but `mimetype`, by name.
  [[nodiscard]] const Entries& entries() const { return entries_; }

 private:
  explicit Package(std::filesystem::path file) : file_(std::move(file)) {}
  std::filesystem::path file_;
  std::string document_;
  Entries entries_;
};

struct PackOptions {
  ExistingFile existing = ExistingFile::replace;
  std::string thumbnail{};  ///< bytes of a PNG; empty: none
  RunOptions run{};
};
struct PackReport {
  std::uint64_t files = 0;     ///< document and files it refers to
  std::uint64_t unpacked = 0;  ///< their bytes
  std::uint64_t bytes = 0;     ///< of the package
};

/// A valid document and its files. Where an element states no SHA-256 of its file, the document in the package does;
/// a stated one that differs is refused (IMPORT_CHANGED). Takes the package's size in memory.
[[nodiscard]] std::optional<PackReport> pack(const std::filesystem::path& document, const std::filesystem::path& out,
                                             const PackOptions& options, DiagnosticSink& sink);
/// What pack() would write, without a thumbnail, to be counted.
[[nodiscard]] std::optional<PackReport> packed_size(const CheckedDocument& checked, const RunOptions& run,
                                                    DiagnosticSink& sink);

/// All entries but `mimetype` as files of a new folder, which appears whole or not at all. An existing folder must be
/// empty, and with ExistingFile::refuse there must be none (WRITE_EXISTS).
[[nodiscard]] std::optional<PackReport> unpack(const std::filesystem::path& package,
                                               const std::filesystem::path& folder, ExistingFile existing,
                                               const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso
