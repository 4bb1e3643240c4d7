// SPDX-License-Identifier: Apache-2.0
#pragma once
// An output file that appears whole or not at all: written beside its target, renamed over it by commit().
//
//   std::optional<OutputFile> file = OutputFile::create("part.stp", ExistingFile::replace, sink);
//   if (file) write_step(body, {}, *file);
//   if (file && file->commit(sink)) ...   // now part.stp exists
//
// Without commit() the destructor removes the temporary. Targets that are not regular files (/dev/stdout, a pipe) are
// written directly. A symbolic link is followed; an existing target keeps its permissions. Errors: WRITE_FAILED (also a
// full disk), WRITE_EXISTS. Not durable against power loss (no fsync). Thread rule: one thread.

#include <cstdint>
#include <optional>
#include <string>

#include "meso/base/byte_sink.hpp"
#include "meso/base/diagnostic.hpp"

namespace meso {

enum class ExistingFile { replace, refuse };

class OutputFile final : public ByteSink {
 public:
  [[nodiscard]] static std::optional<OutputFile> create(const std::string& path, ExistingFile existing,
                                                        DiagnosticSink& sink);
  /// Whether create() would succeed, with its diagnostics if not: to ask before work that takes long. Leaves nothing.
  [[nodiscard]] static bool can_create(const std::string& path, ExistingFile existing, DiagnosticSink& sink);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile() override;

  [[nodiscard]] bool write(std::string_view bytes) override;
  /// Overwrites bytes at `offset`, for counts that are known late; write() goes on where it was. Fails on a pipe.
  [[nodiscard]] bool write_at(std::uint64_t offset, std::string_view bytes);
  /// As if a write had failed with `error` (an errno value). Returns false.
  bool fail(int error) {
    if (error_ == 0) error_ = error;
    return false;
  }

  /// Closes and renames. False, with a diagnostic, if any write or the rename failed; then nothing is left behind.
  [[nodiscard]] bool commit(DiagnosticSink& sink);

  /// The file that must go if the process is interrupted; empty where the target is written directly.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }

 private:
  OutputFile() = default;
  [[nodiscard]] bool publish(DiagnosticSink& sink);
  void discard();

  std::string path_;       // as the caller wrote it, for messages
  std::string target_;     // links followed
  std::string temporary_;  // empty: written directly, or gone
  ExistingFile existing_ = ExistingFile::replace;
  int descriptor_ = -1;
  int error_ = 0;  // errno of the first failed write
};

}  // namespace meso
