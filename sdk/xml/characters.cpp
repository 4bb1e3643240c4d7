// SPDX-License-Identifier: Apache-2.0
#include "characters.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace meso::xml {
namespace {

struct Range {
  char32_t first, last;
};

// XML 1.0 (fifth edition), productions [4] and [4a]; ASCII is tested before.
constexpr std::array name_start_ranges = std::to_array<Range>({{0xC0, 0xD6},
                                                               {0xD8, 0xF6},
                                                               {0xF8, 0x2FF},
                                                               {0x370, 0x37D},
                                                               {0x37F, 0x1FFF},
                                                               {0x200C, 0x200D},
                                                               {0x2070, 0x218F},
                                                               {0x2C00, 0x2FEF},
                                                               {0x3001, 0xD7FF},
                                                               {0xF900, 0xFDCF},
                                                               {0xFDF0, 0xFFFD},
                                                               {0x10000, 0xEFFFF}});
constexpr std::array name_only_ranges = std::to_array<Range>({{0xB7, 0xB7}, {0x300, 0x36F}, {0x203F, 0x2040}});

template <std::size_t N>
bool in_any(const std::array<Range, N>& ranges, char32_t c) {
  return std::any_of(ranges.begin(), ranges.end(), [c](Range r) { return c >= r.first && c <= r.last; });
}

bool is_ascii_letter(char32_t c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

Decoded decode_utf8(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return {first, 1};
  const unsigned length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + length > text.size()) return {};
  char32_t c = first & (0xFFU >> (length + 1));
  for (unsigned i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xC0) != 0x80) return {};
    c = (c << 6) | (byte(at + i) & 0x3FU);
  }
  const bool overlong = (length == 3 && c < 0x800) || (length == 4 && c < 0x10000);
  if (overlong || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF) return {};
  return {c, length};
}

void append_utf8(std::string& out, char32_t c) {
  const auto tail = [&](unsigned shift) { out += static_cast<char>(0x80 | ((c >> shift) & 0x3F)); };
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | (c >> 6));
    tail(0);
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0 | (c >> 12));
    tail(6);
    tail(0);
  } else {
    out += static_cast<char>(0xF0 | (c >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::optional<std::string> utf8_from_utf16(std::string_view bytes, bool big_endian) {
  if (bytes.size() % 2 != 0) return std::nullopt;
  const auto unit = [&](std::size_t i) -> char32_t {
    const auto a = static_cast<unsigned char>(bytes[i]), b = static_cast<unsigned char>(bytes[i + 1]);
    return big_endian ? a * 256U + b : b * 256U + a;
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    char32_t c = unit(i);
    if (c >= 0xD800 && c <= 0xDFFF) {
      const char32_t low = i + 3 < bytes.size() ? unit(i + 2) : 0;
      if (c >= 0xDC00 || low < 0xDC00 || low > 0xDFFF) return std::nullopt;
      c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
      i += 2;
    }
    append_utf8(out, c);
  }
  return out;
}

std::size_t find_bad_character(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte >= 0x20 && byte < 0x80) {
      ++i;
      continue;
    }
    const Decoded d = decode_utf8(text, i);
    if (d.length == 0 || !is_xml_character(d.character)) return i;
    i += d.length;
  }
  return std::string_view::npos;
}

bool is_xml_character(char32_t c) {
  if (c < 0x20) return c == 0x9 || c == 0xA || c == 0xD;
  return c <= 0xD7FF || (c >= 0xE000 && c <= 0xFFFD) || (c >= 0x10000 && c <= 0x10FFFF);
}

bool is_name_start(char32_t c) {
  if (c < 0x80) return is_ascii_letter(c) || c == '_' || c == ':';
  return in_any(name_start_ranges, c);
}

bool is_name_character(char32_t c) {
  if (is_name_start(c)) return true;
  if (c < 0x80) return (c >= '0' && c <= '9') || c == '-' || c == '.';
  return in_any(name_only_ranges, c);
}

std::size_t name_length(std::string_view text, std::size_t at) {
  std::size_t i = at;
  while (i < text.size()) {
    if (i > at && is_ascii_letter(static_cast<unsigned char>(text[i]))) {
      ++i;
      continue;
    }
    const Decoded d = decode_utf8(text, i);
    if (d.length == 0 || !(i == at ? is_name_start(d.character) : is_name_character(d.character))) break;
    i += d.length;
  }
  return i - at;
}

std::optional<char32_t> reference_value(std::string_view reference) {
  if (reference == "lt") return U'<';
  if (reference == "gt") return U'>';
  if (reference == "amp") return U'&';
  if (reference == "quot") return U'"';
  if (reference == "apos") return U'\'';
  if (reference.size() < 2 || reference[0] != '#') return std::nullopt;
  const bool hexadecimal = reference[1] == 'x';
  const std::string_view digits = reference.substr(hexadecimal ? 2 : 1);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  if (!is_xml_character(value)) return std::nullopt;
  return value;
}

std::string normalized_attribute_value(std::string_view raw) {
  std::string out;
  out.reserve(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] == '&') {
      const std::size_t end = raw.find(';', i);
      append_utf8(out, *reference_value(raw.substr(i + 1, end - i - 1)));
      i = end;
    } else if (raw[i] == '\r' && i + 1 < raw.size() && raw[i + 1] == '\n') {
      continue;  // CR LF is one line end, one space
    } else {
      out += is_space(raw[i]) ? ' ' : raw[i];
    }
  }
  return out;
}

std::string with_lf(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool cr_lf = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (!cr_lf) out += text[i] == '\r' ? '\n' : text[i];
  }
  return out;
}

}  // namespace meso::xml
