// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "meso/base/unfinished_files.hpp"
#include "meso/package/package.hpp"

namespace meso {
namespace fs = std::filesystem;
namespace {

bool failed(const fs::path& path, const std::error_code& error, DiagnosticSink& sink) {
  sink.report({.code = Code::write_failed, .args = {path.string(), error.message()}});
  return false;
}

/// A folder that is filled under another name, and is gone unless it was put in place.
class NewFolder {
 public:
  /// `target` as the caller wrote it.
  NewFolder(fs::path target, DiagnosticSink& sink) : target_(std::move(target)), sink_(sink) {
    fs::path plain = target_.lexically_normal();
    if (!plain.has_filename()) plain = plain.parent_path();  // "folder/"
    temporary_ = plain.parent_path() / ("." + plain.filename().string() + "." + std::to_string(getpid()) + "-0.tmp");
  }
  ~NewFolder() {
    std::error_code ignored;
    if (!temporary_.empty())
      finish_unfinished(temporary_.string(), [&] { return fs::remove_all(temporary_, ignored), true; });
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  bool create() {
    std::error_code error;
    if (make_unfinished(temporary_.string(), [&] { return fs::create_directory(temporary_, error); })) return true;
    temporary_.clear();
    return failed(target_, error ? error : std::make_error_code(std::errc::file_exists), sink_);
  }
  bool write(const std::string& name, std::string_view bytes) {
    const fs::path file = temporary_ / fs::path(name);
    std::error_code error;
    const bool made = make_unfinished(temporary_.string(), [&] {
      fs::create_directories(file.parent_path(), error);
      return !error;
    });
    if (!made) return failed(target_ / fs::path(name), error, sink_);
    auto out = OutputFile::create(file.string(), ExistingFile::refuse, sink_);
    if (out) (void)out->write(bytes);  // commit() reports what went wrong
    return out && out->commit(sink_);
  }
  /// In one step; an empty folder is replaced.
  bool publish() {
    std::error_code error;
    const bool renamed = finish_unfinished(temporary_.string(), [&] {
      fs::rename(temporary_, target_, error);
      return !error;
    });
    if (!renamed) return failed(target_, error, sink_);
    temporary_.clear();
    return true;
  }

 private:
  fs::path target_, temporary_;
  DiagnosticSink& sink_;
};

bool may_write(const fs::path& folder, ExistingFile existing, DiagnosticSink& sink) {
  std::error_code error;
  const auto status = fs::symlink_status(folder, error);
  if (!fs::exists(status)) return true;
  if (existing == ExistingFile::replace && fs::is_directory(status) && fs::is_empty(folder, error) && !error)
    return true;
  sink.report({.code = Code::write_exists, .args = {folder.string()}});
  return false;
}

}  // namespace

std::optional<PackReport> unpack(const fs::path& package, const fs::path& folder, ExistingFile existing,
                                 const RunOptions& run, DiagnosticSink& sink) {
  const auto read = Package::read(package, run, sink);
  if (!read || !may_write(folder, existing, sink)) return std::nullopt;
  NewFolder out(folder, sink);
  if (!out.create()) return std::nullopt;
  PackReport report;
  for (const auto& [name, bytes] : read->entries()) {
    if (run.should_stop()) {
      sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
      return std::nullopt;
    }
    if (!out.write(name, *bytes)) return std::nullopt;
    ++report.files;
    report.unpacked += bytes->size();
  }
  std::error_code error;
  report.bytes = fs::file_size(package, error);
  return out.publish() ? std::optional(report) : std::nullopt;
}

}  // namespace meso
