// SPDX-License-Identifier: Apache-2.0
#include "meso/base/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "meso/base/unfinished_files.hpp"

namespace meso {
namespace {

namespace fs = std::filesystem;

std::string error_text(int error) { return std::generic_category().message(error); }

void report_failure(DiagnosticSink& sink, const std::string& path, int error) {
  sink.report({.code = Code::write_failed, .args = {path, error_text(error)}});
}

// The process id keeps two commands apart, the counter two files of one command.
std::string temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name =
      "." + target.filename().string() + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
  return (target.parent_path() / name).string();
}

}  // namespace

std::optional<OutputFile> OutputFile::create(const std::string& path, ExistingFile existing, DiagnosticSink& sink) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (existing == ExistingFile::refuse && fs::exists(status)) {
    sink.report({.code = Code::write_exists, .args = {path}});
    return std::nullopt;
  }
  OutputFile file;
  file.path_ = path;
  file.existing_ = existing;
  const bool direct = fs::exists(status) && !fs::is_regular_file(status);
  if (direct) {
    file.target_ = path;
    file.descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    const fs::path target = fs::weakly_canonical(path, error);
    file.target_ = error ? path : target.string();
    file.temporary_ = temporary_beside(file.target_);
    const auto open = [&] {
      file.descriptor_ = ::open(file.temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      return file.descriptor_ >= 0;
    };
    (void)make_unfinished(file.temporary_, open);
  }
  if (file.descriptor_ < 0) {
    report_failure(sink, path, errno);
    file.temporary_.clear();
    return std::nullopt;
  }
  if (!direct && fs::exists(status)) (void)::fchmod(file.descriptor_, static_cast<mode_t>(status.permissions()));
  return file;
}

bool OutputFile::can_create(const std::string& path, ExistingFile existing, DiagnosticSink& sink) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  // Opening a pipe waits for its reader, and closing it tells that reader that all is said.
  const bool is_direct = fs::exists(status) && !fs::is_regular_file(status);
  return (is_direct && existing == ExistingFile::replace) || create(path, existing, sink);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      existing_(other.existing_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      error_(other.error_) {}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) finish_unfinished(temporary_, [&] { return ::unlink(temporary_.c_str()), true; });
  temporary_.clear();
}

bool OutputFile::write(std::string_view bytes) {
  while (error_ == 0 && !bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      error_ = errno;
  }
  return error_ == 0;
}

bool OutputFile::write_at(std::uint64_t offset, std::string_view bytes) {
  while (error_ == 0 && !bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
      offset += static_cast<std::uint64_t>(written);
    } else if (errno != EINTR) {
      error_ = errno;
    }
  }
  return error_ == 0;
}

bool OutputFile::commit(DiagnosticSink& sink) {
  if (::close(std::exchange(descriptor_, -1)) != 0 && error_ == 0) error_ = errno;
  if (error_ != 0) report_failure(sink, path_, error_);
  const bool published = error_ == 0 && (temporary_.empty() || publish(sink));
  discard();
  return published;
}

bool OutputFile::publish(DiagnosticSink& sink) {
  const auto put_in_place = [&] {
    // A link fails where a file has appeared meanwhile; a rename would replace it.
    if (existing_ == ExistingFile::refuse) {
      if (::link(temporary_.c_str(), target_.c_str()) == 0) return ::unlink(temporary_.c_str()), true;
      if (errno == EEXIST) return false;
    }
    return ::rename(temporary_.c_str(), target_.c_str()) == 0;
  };
  if (!finish_unfinished(temporary_, put_in_place)) {
    if (existing_ == ExistingFile::refuse && errno == EEXIST)
      sink.report({.code = Code::write_exists, .args = {path_}});
    else
      report_failure(sink, path_, errno);
    return false;
  }
  temporary_.clear();
  return true;
}

}  // namespace meso
