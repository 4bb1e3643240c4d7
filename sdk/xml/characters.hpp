// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bytes and characters of XML 1.0: decoding, character classes, references.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meso::xml {

/// length 0: the bytes at this place are not UTF-8 (overlong, surrogate, above U+10FFFF, cut).
struct Decoded {
  char32_t character = 0;
  unsigned length = 0;
};
[[nodiscard]] Decoded decode_utf8(std::string_view text, std::size_t at);
void append_utf8(std::string& out, char32_t character);

/// UTF-8 of UTF-16 code units; empty if a surrogate stands alone or a byte is left over.
[[nodiscard]] std::optional<std::string> utf8_from_utf16(std::string_view bytes, bool big_endian);

/// First byte of `text` that is not UTF-8 or not a character XML allows; npos if there is none.
[[nodiscard]] std::size_t find_bad_character(std::string_view text);

[[nodiscard]] constexpr bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
[[nodiscard]] bool is_xml_character(char32_t c);
[[nodiscard]] bool is_name_start(char32_t c);
[[nodiscard]] bool is_name_character(char32_t c);

/// Bytes of the name that starts at `at`; 0 if none does.
[[nodiscard]] std::size_t name_length(std::string_view text, std::size_t at);

/// Value of what stands between & and ; ("lt", "#65", "#x41"); empty if XML does not define it.
[[nodiscard]] std::optional<char32_t> reference_value(std::string_view reference);
/// An attribute's value as XML defines it: references expanded, white space characters become spaces.
[[nodiscard]] std::string normalized_attribute_value(std::string_view raw);
/// Line ends as LF.
[[nodiscard]] std::string with_lf(std::string_view text);

}  // namespace meso::xml
