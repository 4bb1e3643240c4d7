// SPDX-License-Identifier: Apache-2.0
#include "packed_size.hpp"

#include <zip.h>

#include <memory>

namespace meso::operations {
namespace {

std::optional<std::uint64_t> fail(DiagnosticSink& sink, const char* reason) {
  sink.report({.code = Code::write_failed, .args = {"the packed form in memory", reason}});
  return std::nullopt;
}

struct DiscardArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

bool add_file(zip_t* archive, const std::filesystem::path& file) {
  zip_source_t* source = zip_source_file(archive, file.c_str(), 0, -1);
  if (source == nullptr) return false;
  const zip_int64_t index = zip_file_add(archive, file.filename().c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    return false;
  }
  const auto entry = static_cast<zip_uint64_t>(index);
  return zip_set_file_compression(archive, entry, ZIP_CM_DEFLATE, 9) == 0 &&
         zip_file_set_dostime(archive, entry, 0, 0x21, 0) == 0;
}

}  // namespace

std::optional<std::uint64_t> packed_size(const std::vector<std::filesystem::path>& files, DiagnosticSink& sink) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* buffer = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (buffer == nullptr) return fail(sink, zip_error_strerror(&error));
  std::unique_ptr<zip_t, DiscardArchive> archive(zip_open_from_source(buffer, ZIP_TRUNCATE, &error));
  if (!archive) {
    zip_source_free(buffer);
    return fail(sink, zip_error_strerror(&error));
  }
  zip_source_keep(buffer);  // outlives the archive, to be measured
  const std::unique_ptr<zip_source_t, decltype(&zip_source_free)> kept(buffer, zip_source_free);
  for (const auto& file : files) {
    if (!add_file(archive.get(), file)) return fail(sink, zip_strerror(archive.get()));
  }
  if (zip_close(archive.get()) != 0) return fail(sink, zip_strerror(archive.get()));
  (void)archive.release();
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_source_stat(buffer, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0)
    return fail(sink, "its size is unknown");
  return stat.size;
}

}  // namespace meso::operations
