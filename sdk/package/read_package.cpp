// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <zip.h>

#include <cerrno>
#include <cstring>

#include "entry_rules.hpp"
#include "meso/package/package.hpp"

namespace meso {
namespace fs = std::filesystem;
namespace {

using package::EntryNames;

struct CloseZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};
using Archive = std::unique_ptr<zip_t, CloseZip>;

/// The only method besides storing that every ZIP program knows.
bool is_known_method(const zip_stat_t& stat) {
  return stat.comp_method == ZIP_CM_STORE || stat.comp_method == ZIP_CM_DEFLATE;
}

class PackageReader {
 public:
  PackageReader(const fs::path& file, const RunOptions& run, DiagnosticSink& sink)
      : file_(file.string()), run_(run), sink_(sink) {}

  bool read(Package::Entries& entries, std::string& document) {
    return open() && check_directory() && inflate(entries) && check_media_type() && check_manifest(entries) &&
           find_document(entries, document);
  }

 private:
  bool fault(Code code, std::vector<std::string> args) {
    args.insert(args.begin(), file_);
    sink_.report({.code = code, .where = {.file = file_}, .args = std::move(args)});
    return false;
  }
  bool unreadable(std::string why) { return fault(Code::package_unreadable, {std::move(why)}); }
  bool bad_entry(std::string_view name, std::string why) {
    std::string shown(name.substr(0, package::longest_name));
    for (char& c : shown) c = static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return fault(Code::package_entry, {std::move(shown), std::move(why)});
  }

  bool stopped() {
    if (!run_.should_stop()) return false;
    sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
    return true;
  }

  bool open() {
    std::error_code error;
    const auto status = fs::status(file_, error);
    if (!fs::is_regular_file(status)) {
      const char* why = !fs::exists(status) ? "no such file" : "it is no regular file";
      sink_.report({.code = Code::file_not_found, .where = {.file = file_}, .args = {file_, why}});
      return false;
    }
    int code = 0;
    archive_.reset(zip_open(file_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code));
    if (archive_) return true;
    zip_error_t why;
    zip_error_init_with_code(&why, code);
    const std::string text = code == ZIP_ER_NOZIP    ? "it is no ZIP file, or cut short"
                             : code == ZIP_ER_EXISTS ? "two of its entries have one name"
                                                     : zip_error_strerror(&why);
    zip_error_fini(&why);
    return unreadable(text);
  }

  /// Everything that can be known before a byte is inflated.
  bool check_directory() {
    const auto count = static_cast<zip_uint64_t>(zip_get_num_entries(archive_.get(), 0));
    EntryNames names;
    std::uint64_t total = 0;
    for (zip_uint64_t i = 0; i < count; ++i) {
      if (stopped()) return false;
      zip_stat_t stat;
      const char* name = zip_get_name(archive_.get(), i, ZIP_FL_ENC_RAW);
      if (name == nullptr || zip_stat_index(archive_.get(), i, ZIP_FL_ENC_RAW, &stat) != 0)
        return unreadable(zip_strerror(archive_.get()));
      std::string why = package::name_fault(name);
      if (why.empty()) why = names.add(name);
      if (why.empty() && is_link(i)) why = "it is a link, not a file";
      if (why.empty() && (stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
        why = "it is encrypted";
      if (why.empty() && !is_known_method(stat)) why = "it is compressed by another method than deflate";
      if (!why.empty()) return bad_entry(name, std::move(why));
      if (i == 0 && (name != package::media_type_entry || stat.comp_method != ZIP_CM_STORE))
        return fault(Code::package_incomplete, {"stored '" + std::string(package::media_type_entry) + "' in front"});
      if (__builtin_add_overflow(total, stat.size, &total) || total > run_.max_memory_bytes)
        return fault(Code::package_too_large, {std::to_string(total), std::to_string(run_.max_memory_bytes)});
      listed_.push_back({name, stat.size});
    }
    if (count == 0) return fault(Code::package_incomplete, {"entries"});
    return true;
  }
  bool is_link(zip_uint64_t index) {
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    if (zip_file_get_external_attributes(archive_.get(), index, 0, &system, &attributes) != 0) return false;
    const auto type = static_cast<mode_t>(attributes >> 16) & S_IFMT;
    return system == ZIP_OPSYS_UNIX && type != 0 && type != S_IFREG;
  }

  bool inflate(Package::Entries& entries) {
    for (std::size_t i = 0; i < listed_.size(); ++i) {
      const Listed& entry = listed_[i];
      const std::unique_ptr<zip_file_t, CloseZip> stream(zip_fopen_index(archive_.get(), i, 0));
      if (!stream) return unreadable("'" + entry.name + "': " + zip_strerror(archive_.get()));
      auto bytes = std::make_shared<std::string>();
      // The library ends with an error where the bytes are more or fewer than stated, or have another CRC.
      for (zip_int64_t got = 1; got > 0;) {
        if (stopped()) return false;
        const std::size_t had = bytes->size();
        bytes->resize(had + std::min<std::uint64_t>(block, entry.size - had + 1));
        got = zip_fread(stream.get(), bytes->data() + had, bytes->size() - had);
        if (got < 0) return unreadable("'" + entry.name + "': " + zip_error_strerror(zip_file_get_error(stream.get())));
        bytes->resize(had + static_cast<std::size_t>(got));
        if (bytes->size() > entry.size) return unreadable("'" + entry.name + "' is longer than stated");
      }
      if (bytes->size() != entry.size) return unreadable("'" + entry.name + "' is shorter than stated");
      if (i == 0)
        media_type_ = *bytes;
      else
        entries.emplace(entry.name, std::move(bytes));
    }
    return true;
  }

  bool check_media_type() {
    return media_type_ == package::media_type ||
           bad_entry(package::media_type_entry, "it does not say " + std::string(package::media_type));
  }

  /// Lines of `sha256sum`: every entry but the first and the manifest itself, each once.
  bool check_manifest(const Package::Entries& entries) {
    const auto manifest = entries.find(std::string(package::manifest_entry));
    if (manifest == entries.end()) return fault(Code::package_incomplete, {std::string(package::manifest_entry)});
    std::map<std::string, std::string, std::less<>> sums;
    const std::string_view text = *manifest->second;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      const std::string_view line = text.substr(at, end - at);
      constexpr std::size_t sum_digits = 64, name_at = sum_digits + 2;
      const std::string_view sum = line.substr(0, std::min(line.size(), sum_digits));
      const bool is_sum = sum.find_first_not_of("0123456789abcdef") == std::string_view::npos;
      if (end == std::string_view::npos || line.size() <= name_at || !is_sum || line.substr(sum_digits, 2) != "  " ||
          !sums.emplace(line.substr(name_at), sum).second)
        return bad_entry(package::manifest_entry,
                         "line " + std::to_string(sums.size() + 1) + " is not a sum, two spaces and a new name");
      at = end + 1;
    }
    for (const auto& [name, bytes] : entries) {
      if (name == package::manifest_entry) continue;
      const auto stated = sums.find(name);
      if (stated == sums.end()) return bad_entry(name, "the manifest does not list it");
      const std::string sum = sha256_of_bytes(*bytes);
      if (sum != stated->second) return fault(Code::package_changed, {name, sum, stated->second});
      sums.erase(stated);
    }
    return sums.empty() || fault(Code::package_incomplete, {"'" + sums.begin()->first + "', which its manifest lists"});
  }

  bool find_document(const Package::Entries& entries, std::string& document) {
    for (const auto& [name, bytes] : entries) {
      if (!package::is_document_name(name)) continue;
      if (!document.empty()) return bad_entry(name, "'" + document + "' is the document already");
      document = name;
    }
    return !document.empty() || fault(Code::package_incomplete, {"document (.meso)"});
  }

  static constexpr std::uint64_t block = 1 << 22;
  struct Listed {
    std::string name;
    std::uint64_t size = 0;
  };
  std::string file_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  Archive archive_;
  std::vector<Listed> listed_;
  std::string media_type_;
};

}  // namespace

std::shared_ptr<const Package> Package::read(const fs::path& file, const RunOptions& run, DiagnosticSink& sink) {
  const std::shared_ptr<Package> package(new Package(file));
  return PackageReader(file, run, sink).read(package->entries_, package->document_) ? package : nullptr;
}

std::optional<Resource> Package::find(std::string_view href) const {
  const auto name = normalized_href(href);
  if (!name) return std::nullopt;
  const auto entry = entries_.find(*name);
  // A package is no folder: a file below it does not exist.
  return entry == entries_.end() ? Resource(file_ / *name) : Resource(file_ / *name, entry->second);
}

}  // namespace meso
