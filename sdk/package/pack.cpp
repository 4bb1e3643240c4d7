// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "entry_rules.hpp"
#include "meso/package/open_document.hpp"
#include "meso/package/package.hpp"
#include "meso/package/referenced_files.hpp"
#include "meso/zip/zip_writer.hpp"

namespace meso {
namespace fs = std::filesystem;
namespace {

/// Views of bytes that outlive the archive.
using Contents = std::map<std::string, std::string_view>;

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

  bool compress(ZipTarget& target) {
    ZipWriter zip(target, run_);
    bool good = zip.add(std::string(package::media_type_entry), package::media_type, ZipMethod::store);
    for (const auto& [name, bytes] : contents_) good = good && zip.add(name, bytes, ZipMethod::deflate);
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
  if (!packing.collect(options.thumbnail)) return std::nullopt;
  auto file = OutputFile::create(out.string(), options.existing, sink);
  if (!file) return std::nullopt;
  ZipToFile target(*file);
  return packing.compress(target) && file->commit(sink) ? std::optional(packing.report()) : std::nullopt;
}

std::optional<PackReport> packed_size(const CheckedDocument& checked, const RunOptions& run, DiagnosticSink& sink) {
  Packing packing(checked, "in memory", run, sink);
  ZipSize nowhere;
  return packing.collect({}) && packing.compress(nowhere) ? std::optional(packing.report()) : std::nullopt;
}

}  // namespace meso
