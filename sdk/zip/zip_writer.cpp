// SPDX-License-Identifier: Apache-2.0
#include "meso/zip/zip_writer.hpp"

#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>

namespace meso {
namespace {

struct DiscardZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

/// What libzip asks of a file that it writes and never reads.
class Source {
 public:
  explicit Source(ZipTarget& target) : target_(target) { zip_error_init(&error_); }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() { zip_error_fini(&error_); }

  static zip_int64_t ask(void* self, void* data, zip_uint64_t length, zip_source_cmd_t command) {
    return static_cast<Source*>(self)->answer(data, length, command);
  }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  zip_int64_t answer(void* data, zip_uint64_t length, zip_source_cmd_t command) {
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        // It wants to read and seek: at first, an archive that is empty.
        return zip_source_make_command_bitmap(
            ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_SEEK, ZIP_SOURCE_TELL, ZIP_SOURCE_STAT,
            ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, ZIP_SOURCE_REMOVE, ZIP_SOURCE_BEGIN_WRITE, ZIP_SOURCE_WRITE,
            ZIP_SOURCE_SEEK_WRITE, ZIP_SOURCE_TELL_WRITE, ZIP_SOURCE_COMMIT_WRITE, ZIP_SOURCE_ROLLBACK_WRITE, -1);
      case ZIP_SOURCE_STAT:
        return stat(data, length);
      case ZIP_SOURCE_WRITE:
        return write({static_cast<const char*>(data), length});
      case ZIP_SOURCE_SEEK_WRITE: {
        const zip_int64_t to = zip_source_seek_compute_offset(at_, size_, data, length, &error_);
        if (to >= 0) at_ = static_cast<std::uint64_t>(to);
        return to < 0 ? -1 : 0;
      }
      case ZIP_SOURCE_TELL_WRITE:
        return static_cast<zip_int64_t>(at_);
      case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&error_, data, length);
      case ZIP_SOURCE_OPEN:
      case ZIP_SOURCE_READ:
      case ZIP_SOURCE_CLOSE:
      case ZIP_SOURCE_SEEK:
      case ZIP_SOURCE_TELL:
      case ZIP_SOURCE_BEGIN_WRITE:
      case ZIP_SOURCE_COMMIT_WRITE:
      case ZIP_SOURCE_ROLLBACK_WRITE:
      case ZIP_SOURCE_REMOVE:
      case ZIP_SOURCE_FREE:
        return 0;
      default:
        zip_error_set(&error_, ZIP_ER_OPNOTSUPP, 0);
        return -1;
    }
  }

  zip_int64_t stat(void* data, zip_uint64_t length) {
    zip_stat_t* stat = ZIP_SOURCE_GET_ARGS(zip_stat_t, data, length, &error_);
    if (stat == nullptr) return -1;
    zip_stat_init(stat);
    stat->size = size_;
    stat->valid |= ZIP_STAT_SIZE;
    return sizeof *stat;
  }

  zip_int64_t write(std::string_view bytes) {
    if (!target_.write_at(at_, bytes)) {
      zip_error_set(&error_, ZIP_ER_WRITE, 0);
      return -1;
    }
    at_ += bytes.size();
    size_ = std::max(size_, at_);
    return static_cast<zip_int64_t>(bytes.size());
  }

  ZipTarget& target_;
  zip_error_t error_{};
  std::uint64_t at_ = 0, size_ = 0;
};

}  // namespace

bool ZipToFile::write_at(std::uint64_t offset, std::string_view bytes) {
  const std::string_view over =
      bytes.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(size_ - offset, bytes.size())));
  const std::string_view beyond = bytes.substr(over.size());
  size_ += beyond.size();
  return (over.empty() || file_.write_at(offset, over)) && (beyond.empty() || file_.write(beyond));
}

class ZipWriter::Archive {
 public:
  Archive(ZipTarget& target, const RunOptions& run) : source_(target), run_(run) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_function_create(Source::ask, &source_, &error);
    if (source != nullptr) {
      archive_.reset(zip_open_from_source(source, ZIP_TRUNCATE, &error));
      if (!archive_) zip_source_free(source);
    }
    if (archive_)
      zip_register_cancel_callback_with_state(
          archive_.get(), [](zip_t*, void* self) { return static_cast<Archive*>(self)->run_.should_stop() ? 1 : 0; },
          nullptr, this);
    else
      why_ = zip_error_strerror(&error);
    zip_error_fini(&error);
  }

  template <class MakeSource>
  bool add(const std::string& name, ZipMethod method, const MakeSource& make_source) {
    if (!archive_) return false;
    zip_source_t* source = make_source(archive_.get());
    const zip_int64_t index =
        source == nullptr ? -1 : zip_file_add(archive_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0 && source != nullptr) zip_source_free(source);
    return (index >= 0 && describe(static_cast<zip_uint64_t>(index), method)) || fail();
  }

  bool close() {
    if (!archive_ || !why_.empty()) return false;
    if (zip_close(archive_.get()) != 0) return fail();
    (void)archive_.release();
    return true;
  }
  [[nodiscard]] std::uint64_t size() const { return source_.size(); }
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  bool describe(zip_uint64_t entry, ZipMethod method) {
    constexpr zip_uint32_t mode = S_IFREG | 0644;
    constexpr zip_uint16_t first_day = 0x21;  // 1980-01-01, the first that ZIP knows
    const zip_uint32_t level = method == ZipMethod::fast ? 1 : 9;
    return zip_set_file_compression(archive_.get(), entry, method == ZipMethod::store ? ZIP_CM_STORE : ZIP_CM_DEFLATE,
                                    method == ZipMethod::store ? 0 : level) == 0 &&
           zip_file_set_dostime(archive_.get(), entry, 0, first_day, 0) == 0 &&
           zip_file_set_external_attributes(archive_.get(), entry, 0, ZIP_OPSYS_UNIX, mode << 16) == 0;
  }
  bool fail() {
    if (why_.empty()) why_ = zip_strerror(archive_.get());
    return false;
  }

  Source source_;  // before the archive: it is asked while that is discarded
  const RunOptions& run_;
  std::unique_ptr<zip_t, DiscardZip> archive_;
  std::string why_;
};

ZipWriter::ZipWriter(ZipTarget& target, const RunOptions& run) : archive_(std::make_unique<Archive>(target, run)) {}
ZipWriter::~ZipWriter() = default;

bool ZipWriter::add(const std::string& name, std::string_view bytes, ZipMethod method) {
  return archive_->add(name, method, [&](zip_t* zip) { return zip_source_buffer(zip, bytes.data(), bytes.size(), 0); });
}

bool ZipWriter::add(const std::string& name, std::FILE* file, ZipMethod method) {
  return archive_->add(name, method, [&](zip_t* zip) {
    // libzip closes what it is given, the caller his own.
    const int descriptor = std::fseek(file, 0, SEEK_SET) == 0 ? dup(fileno(file)) : -1;
    std::FILE* copy = descriptor < 0 ? nullptr : fdopen(descriptor, "rb");
    if (copy == nullptr && descriptor >= 0) ::close(descriptor);
    return copy == nullptr ? nullptr : zip_source_filep(zip, copy, 0, -1);
  });
}

bool ZipWriter::close() { return archive_->close(); }
std::uint64_t ZipWriter::size() const { return archive_->size(); }
const std::string& ZipWriter::why() const { return archive_->why(); }

}  // namespace meso
