// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which names may stand in a package, the same for reading and writing (docs/specification/package.md). Private.

#include <set>
#include <string>
#include <string_view>

namespace meso::package {

inline constexpr std::string_view media_type = "application/vnd.meso+zip";
inline constexpr std::string_view media_type_entry = "mimetype";
inline constexpr std::string_view manifest_entry = "manifest.sha256";
inline constexpr std::string_view thumbnail_entry = "thumbnail.png";
inline constexpr std::size_t longest_name = 1024;  ///< bytes

/// Of the document or of a file that it refers to.
[[nodiscard]] bool is_reserved(std::string_view name);

/// An entry at the root whose extension is .meso.
[[nodiscard]] bool is_document_name(std::string_view name);

/// What is wrong with the name of an entry; empty: nothing.
[[nodiscard]] std::string name_fault(std::string_view name);

/// Names that could not all be files of one folder.
class EntryNames {
 public:
  /// What is wrong with one more entry; empty: nothing.
  [[nodiscard]] std::string add(const std::string& name);

 private:
  std::set<std::string, std::less<>> known_;  // in lower case
};

}  // namespace meso::package
