// SPDX-License-Identifier: Apache-2.0
#include "meso/model/source_map.hpp"

#include <algorithm>

namespace meso {
namespace {

bool is_utf8_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

std::size_t utf8_length(unsigned long code_point) {
  return code_point < 0x80 ? 1 : code_point < 0x800 ? 2 : code_point < 0x10000 ? 3 : 4;
}

/// Bytes that the reference raw[0, length) stands for: 1 for &lt;, up to 4 for &#x1F600;.
std::size_t expanded_bytes(std::string_view reference) {
  if (reference.size() < 4 || reference[1] != '#') return 1;
  const bool hexadecimal = reference[2] == 'x';
  return utf8_length(std::stoul(std::string(reference.substr(hexadecimal ? 3 : 2)), nullptr, hexadecimal ? 16 : 10));
}

/// Raw offset of the expanded offset `target`.
std::size_t raw_offset(std::string_view raw, std::size_t target) {
  std::size_t expanded = 0, i = 0;
  while (i < raw.size() && expanded < target) {
    const std::size_t end = raw[i] == '&' ? raw.find(';', i) : std::string_view::npos;
    if (end == std::string_view::npos) {
      ++i;
      ++expanded;
    } else {
      expanded += expanded_bytes(raw.substr(i, end - i));
      i = end + 1;
    }
  }
  return i;
}

}  // namespace

SourceMap::SourceMap(std::string file, std::string text)
    : file_(std::move(file)), text_(std::move(text)), line_starts_{0} {
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n')))
      line_starts_.push_back(i + 1);
  }
}

ElementId SourceMap::add(ElementPlace place) {
  places_.push_back(std::move(place));
  return {static_cast<std::uint32_t>(places_.size())};
}

std::string SourceMap::path(ElementId id, std::string_view attribute) const {
  if (!knows(id)) return {};
  const std::string& path = at(id).path;
  return attribute.empty() ? path : path + "/@" + std::string(attribute);
}

SourceSpan SourceMap::span(ElementId id) const {
  if (!knows(id)) return {.file = file_};
  return span_at(at(id).offset, at(id).length);
}

SourceSpan SourceMap::span(ElementId id, std::string_view attribute, std::size_t offset, std::size_t length) const {
  if (!knows(id)) return {.file = file_};
  const auto& attributes = at(id).attributes;
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const auto& a) { return a.name == attribute; });
  if (found == attributes.end()) return span(id);
  const std::string_view raw = std::string_view(text_).substr(found->value_offset, found->value_length);
  const std::size_t first = raw_offset(raw, offset);
  const std::size_t last = length == 0 ? raw.size() : raw_offset(raw, offset + length);
  return span_at(found->value_offset + first, last - first);
}

SourceSpan SourceMap::span_at(std::size_t offset, std::size_t length) const {
  if (line_starts_.empty()) return {.file = file_};
  const std::size_t end = std::min(offset, text_.size());
  const auto line = std::upper_bound(line_starts_.begin(), line_starts_.end(), end) - 1;
  std::size_t column = 1;
  for (std::size_t i = *line; i < end; ++i) column += is_utf8_continuation(text_[i]) ? 0 : 1;
  return {.file = file_,
          .offset = offset,
          .length = length,
          .line = static_cast<std::size_t>(line - line_starts_.begin()) + 1,
          .column = column};
}

}  // namespace meso
