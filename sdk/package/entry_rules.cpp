// SPDX-License-Identifier: Apache-2.0
#include "entry_rules.hpp"

#include <algorithm>
#include <cstdint>

namespace meso::package {
namespace {

/// Length of the UTF-8 sequence at the beginning; 0: there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 && first < 0xF5 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (length == 0 || first >= 0xF5 || text.size() < length) return 0;
  std::uint32_t code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  static constexpr std::uint32_t least[]{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code < 0xE000;
  return code >= least[length] && code < 0x110000 && !is_surrogate ? length : 0;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return text;
}

}  // namespace

bool is_reserved(std::string_view name) {
  return name == media_type_entry || name == manifest_entry || name == thumbnail_entry;
}

bool is_document_name(std::string_view name) {
  return name.ends_with(".meso") && name.find('/') == std::string_view::npos;
}

std::string name_fault(std::string_view name) {
  if (name.empty()) return "it has no name";
  if (name.size() > longest_name) return "its name is too long";
  if (name.front() == '/') return "its path is absolute";
  if (name.back() == '/') return "it is a folder; folders come from the names of files";
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = utf8_length(name.substr(at));
    if (length == 0) return "its name is not UTF-8";
    const char c = name[at];
    if (c == '\\') return "its name has a backslash; folders are parted by /";
    if (c == ':') return "its name has a colon";
    if (static_cast<unsigned char>(c) < 32 || c == 127) return "its name has a control character";
    at += length;
  }
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    const std::string_view step = name.substr(at, end - at);
    if (step == "..") return "its path leads out of the package";
    if (step.empty() || step == ".") return "its path is not in its shortest form";
    at = end + 1;
  }
  return {};
}

std::string EntryNames::add(const std::string& name) {
  const std::string key = lower(name), folder = key + '/';
  // Folders are looked for and not kept: a name of many short steps would have as many prefixes of its own length.
  for (std::size_t slash = key.find('/'); slash != std::string::npos; slash = key.find('/', slash + 1)) {
    if (known_.contains(std::string_view(key).substr(0, slash))) return "one of its folders is the name of a file";
  }
  const auto below = known_.lower_bound(folder);
  if (below != known_.end() && below->starts_with(folder)) return "other entries have this name as their folder";
  return known_.insert(key).second ? "" : "another entry has this name (A and a count as equal)";
}

}  // namespace meso::package
