// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/number_block.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cassert>
#include <cstdlib>
#include <string>
#include <vector>

namespace meso::fields {
namespace {

/// A file without a name, or -1. O_TMPFILE is not known to every file system.
int nameless_file(const std::string& folder) {
  const int found = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600);
  if (found >= 0) return found;
  std::string name = folder + "/meso-XXXXXX";
  const int made = ::mkostemp(name.data(), O_CLOEXEC);
  if (made >= 0) ::unlink(name.c_str());
  return made;
}

std::vector<std::string> folders() {
  // An empty TMPDIR names no folder. /tmp may itself be memory, /var/tmp is not.
  const char* const named = std::getenv("TMPDIR");
  if (named != nullptr && *named != '\0') return {named};
  return {"/var/tmp", "/tmp"};
}

}  // namespace

std::optional<NumberBlock> NumberBlock::make(std::uint64_t count, const RunOptions& run, DiagnosticSink& sink) {
  assert(count > 0 && count >> 60 == 0);
  const std::size_t size = count * sizeof(double);
  // Pages of memory that nobody has written to cost nothing, so bounds of a count are as good as the count.
  void* bytes = MAP_FAILED;
  if (is_in_memory(count, run)) {
    bytes = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  } else {
    const std::vector<std::string> all = folders();
    for (const std::string& folder : all) {
      const int file = nameless_file(folder);
      if (file < 0) continue;
      // Room that is promised now cannot fail as a signal later.
      if (::posix_fallocate(file, 0, static_cast<off_t>(size)) == 0)
        bytes = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      ::close(file);
      if (bytes != MAP_FAILED) break;
    }
  }
  if (bytes == MAP_FAILED) {
    sink.report({.code = Code::field_no_space, .args = {std::to_string(size >> 20), folders().front()}});
    return std::nullopt;
  }
  NumberBlock block;
  block.bytes_ = std::shared_ptr<void>(bytes, [size](void* p) { ::munmap(p, size); });
  return block;
}

Records NumberBlock::records(std::size_t rows, std::size_t columns) && {
  const auto* const first = static_cast<const std::byte*>(bytes_.get());
  return Records::within(std::move(bytes_), first, rows, columns);
}

}  // namespace meso::fields
