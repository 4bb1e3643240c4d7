// SPDX-License-Identifier: Apache-2.0
#pragma once
// One ZIP archive, compressed straight into where it goes.
//
//   ZipToFile target(*file);               // or ZipSize, to know how large it would be
//   ZipWriter zip(target, run);
//   zip.add("readme.txt", text, {});
//   if (zip.close() && file->commit(sink)) ...
//
// Equal entries give equal bytes: all are of 1980-01-01 and of mode 0644. ZIP64 where an entry needs it (4 GiB),
// nowhere else. Thread rule: one thread.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"

namespace meso {

/// Where an archive's bytes go: mostly to the end; sizes are put into headers later.
class ZipTarget {
 public:
  ZipTarget() = default;
  ZipTarget(const ZipTarget&) = delete;
  ZipTarget& operator=(const ZipTarget&) = delete;
  virtual ~ZipTarget() = default;
  /// `offset` is at most what was written so far. False once anything failed.
  [[nodiscard]] virtual bool write_at(std::uint64_t offset, std::string_view bytes) = 0;
};

class ZipToFile final : public ZipTarget {
 public:
  explicit ZipToFile(OutputFile& file) : file_(file) {}
  [[nodiscard]] bool write_at(std::uint64_t offset, std::string_view bytes) override;

 private:
  OutputFile& file_;
  std::uint64_t size_ = 0;
};

/// Keeps nothing.
class ZipSize final : public ZipTarget {
 public:
  [[nodiscard]] bool write_at(std::uint64_t, std::string_view) override { return true; }
};

enum class ZipMethod {
  store,
  deflate,  ///< as small as it gets
  fast,     ///< a few percent larger, several times as fast: for what is made in gigabytes
};

class ZipWriter {
 public:
  /// `target` and `run` must outlive the writer; so must what is added, until close().
  ZipWriter(ZipTarget& target, const RunOptions& run);
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;
  ~ZipWriter();

  bool add(const std::string& name, std::string_view bytes, ZipMethod method);
  /// All of `file`, from its begin on.
  bool add(const std::string& name, std::FILE* file, ZipMethod method);

  /// Compresses and writes. False if anything failed since the constructor, or `run` is to stop: then why() says it.
  [[nodiscard]] bool close();
  /// Of the archive, after close().
  [[nodiscard]] std::uint64_t size() const;
  [[nodiscard]] const std::string& why() const;

 private:
  class Archive;
  std::unique_ptr<Archive> archive_;
};

}  // namespace meso
