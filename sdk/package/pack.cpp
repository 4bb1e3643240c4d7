// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <zip.h>

#include <cerrno>
#include <memory>

#include "entry_rules.hpp"
#include "meso/package/open_document.hpp"
#include "meso/package/package.hpp"
#include "meso/package/referenced_files.hpp"

namespace meso {
namespace fs = std::filesystem;
namespace {

struct DiscardZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

/// Views of bytes that outlive the archive.
using Contents = std::map<std::string, std::string_view>;

/// One archive in memory. Nothing in it tells when, where or by whom it was made.
class ZipInMemory {
 public:
  explicit ZipInMemory(const RunOptions& run) : run_(run) {
    zip_source_t* buffer = zip_source_buffer_create(nullptr, 0, 0, nullptr);
    if (buffer == nullptr) return;
    archive_.reset(zip_open_from_source(buffer, ZIP_TRUNCATE, nullptr));
    if (!archive_) {
      zip_source_free(buffer);
      return;
    }
    zip_source_keep(buffer);  // outlives the archive, to be read
    buffer_.reset(buffer);
    zip_register_cancel_callback_with_state(
        archive_.get(), [](zip_t*, void* self) { return static_cast<ZipInMemory*>(self)->run_.should_stop() ? 1 : 0; },
        nullptr, this);
  }

  bool add(const std::string& name, std::string_view bytes, int method) {
    if (!archive_) return false;
    zip_source_t* source = zip_source_buffer(archive_.get(), bytes.data(), bytes.size(), 0);
    if (source == nullptr) return false;
    const zip_int64_t index = zip_file_add(archive_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      return false;
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    constexpr zip_uint32_t mode = S_IFREG | 0644;
    constexpr zip_uint16_t first_day = 0x21;  // 1980-01-01, the first that ZIP knows
    constexpr int best = 9;
    return zip_set_file_compression(archive_.get(), entry, method, best) == 0 &&
           zip_file_set_dostime(archive_.get(), entry, 0, first_day, 0) == 0 &&
           zip_file_set_external_attributes(archive_.get(), entry, 0, ZIP_OPSYS_UNIX, mode << 16) == 0;
  }

  /// Compresses.
  bool close() {
    if (!archive_ || zip_close(archive_.get()) != 0) return false;
    (void)archive_.release();
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_source_stat(buffer_.get(), &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0) return false;
    size_ = stat.size;
    return true;
  }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  bool copy_to(OutputFile& out) {
    if (zip_source_open(buffer_.get()) != 0) return false;
    std::string block(1 << 20, '\0');
    zip_int64_t got = 0;
    do {
      got = zip_source_read(buffer_.get(), block.data(), block.size());
    } while (got > 0 && out.write(std::string_view(block).substr(0, static_cast<std::size_t>(got))));
    zip_source_close(buffer_.get());
    return got == 0;
  }

  [[nodiscard]] std::string why() const { return archive_ ? zip_strerror(archive_.get()) : "out of memory"; }

 private:
  const RunOptions& run_;
  std::unique_ptr<zip_source_t, decltype(&zip_source_free)> buffer_{nullptr, zip_source_free};
  std::unique_ptr<zip_t, DiscardZip> archive_;
  std::uint64_t size_ = 0;
};

/// What goes into a package, held open.
class Packing {
 public:
  Packing(const CheckedDocument& checked, std::string out, const RunOptions& run, DiagnosticSink& sink)
      : checked_(checked), out_(std::move(out)), run_(run), sink_(sink) {}

  bool collect(const std::string& thumbnail) {
    std::vector<ReferencedFile> files = referenced_files(checked_);
    if (!add_document(files)) return false;
    for (const ReferencedFile& file : files) {
      if (!add_file(file)) return false;
    }
    report_.files = contents_.size();
    for (const auto& [name, bytes] : contents_) report_.unpacked += bytes.size();
    if (!thumbnail.empty()) contents_.emplace(package::thumbnail_entry, thumbnail);
    for (const auto& [name, bytes] : contents_) manifest_ += sha256_of_bytes(bytes) + "  " + name + "\n";
    contents_.emplace(package::manifest_entry, manifest_);
    return true;
  }

  bool compress(ZipInMemory& zip) {
    bool good = zip.add(std::string(package::media_type_entry), package::media_type, ZIP_CM_STORE);
    for (const auto& [name, bytes] : contents_) good = good && zip.add(name, bytes, ZIP_CM_DEFLATE);
    if (good && zip.close()) {
      report_.bytes = zip.size();
      return true;
    }
    if (run_.should_stop())
      sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
    else
      sink_.report({.code = Code::write_failed, .args = {out_, zip.why()}});
    return false;
  }

  [[nodiscard]] const PackReport& report() const { return report_; }

 private:
  bool refuse(const std::string& name, std::string why) {
    sink_.report({.code = Code::package_entry,
                  .where = {.file = checked_.source().file()},
                  .args = {out_, name, std::move(why)}});
    return false;
  }
  bool add(const std::string& name, std::string_view bytes) {
    std::string why = package::name_fault(name);
    if (why.empty()) why = names_.add(name);
    if (why.empty() && package::is_reserved(name)) why = "the package itself has a file of this name";
    if (!why.empty()) return refuse(name, std::move(why));
    contents_.emplace(name, bytes);
    return true;
  }

  /// The document's text with a sum for every file; nothing else in it changes.
  bool add_document(const std::vector<ReferencedFile>& files) {
    std::map<std::size_t, std::string> insertions;  // by offset in the text
    for (const ReferencedFile& file : files) {
      if (!open(file)) return false;
      const std::string sum = sha256_of_bytes(opened_.back()->view());
      for (const ReferencedFile::Use& use : file.uses) {
        if (!use.has_sha256) {
          const SourceSpan href = checked_.source().span(use.element, "href");
          insertions.emplace(href.offset + href.length + 1, " sha256=\"" + sum + "\"");  // behind the quotation mark
        } else if (const SourceSpan place = checked_.source().span(use.element, "sha256");
                   checked_.source().text().substr(place.offset, place.length) != sum) {
          sink_.report({.code = Code::import_changed,
                        .where = place,
                        .path = checked_.source().path(use.element, "sha256"),
                        .args = {file.name, sum, checked_.source().text().substr(place.offset, place.length)}});
          return false;
        }
      }
    }
    document_ = checked_.source().text();
    for (auto at = insertions.rbegin(); at != insertions.rend(); ++at) document_.insert(at->first, at->second);
    const std::string name = fs::path(checked_.source().file()).filename().string();
    if (!package::is_document_name(name)) return refuse(name, "the document's name does not end in .meso");
    return add(name, document_);
  }
  bool open(const ReferencedFile& file) {
    std::string why;
    opened_.push_back(ResourceBytes::open(file.resource, why));
    if (opened_.back()) return true;
    sink_.report({.code = Code::import_unreadable,
                  .where = checked_.source().span(file.uses.front().element, "href"),
                  .path = checked_.source().path(file.uses.front().element, "href"),
                  .args = {file.name, why}});
    return false;
  }
  bool add_file(const ReferencedFile& file) {
    if (package::is_document_name(file.name)) return refuse(file.name, "the document alone ends in .meso there");
    return add(file.name, opened_[added_++]->view());
  }

  const CheckedDocument& checked_;
  std::string out_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  std::vector<std::shared_ptr<const ResourceBytes>> opened_;  // in the order of the files
  std::size_t added_ = 0;
  std::string document_, manifest_;
  Contents contents_;
  package::EntryNames names_;
  PackReport report_;
};

}  // namespace

std::optional<PackReport> pack(const fs::path& document, const fs::path& out, const PackOptions& options,
                               DiagnosticSink& sink) {
  const auto checked = open_checked_document(document, options.run, sink);
  if (!checked) return std::nullopt;
  Packing packing(*checked, out.string(), options.run, sink);
  ZipInMemory zip(options.run);
  if (!packing.collect(options.thumbnail) || !packing.compress(zip)) return std::nullopt;
  auto file = OutputFile::create(out.string(), options.existing, sink);
  if (!file) return std::nullopt;
  if (!zip.copy_to(*file)) (void)file->fail(ENOMEM);
  return file->commit(sink) ? std::optional(packing.report()) : std::nullopt;
}

std::optional<PackReport> packed_size(const CheckedDocument& checked, const RunOptions& run, DiagnosticSink& sink) {
  Packing packing(checked, "in memory", run, sink);
  ZipInMemory zip(run);
  return packing.collect({}) && packing.compress(zip) ? std::optional(packing.report()) : std::nullopt;
}

}  // namespace meso
