// SPDX-License-Identifier: Apache-2.0
#include "step_text.hpp"

#include <algorithm>
#include <cstring>

namespace meso::step {

// The shortest digits that read back as the same double, in STEP's spelling: always a point, exponent E.
void StepText::real(double value) {
  char* const begin = buffer_->claim(longest_number);
  char* end = std::to_chars(begin, begin + longest_number, value + 0.0).ptr;  // + 0.0: no "-0."
  char* const exponent = std::find(begin, end, 'e');
  if (exponent != end) *exponent = 'E';
  if (std::find(begin, exponent, '.') == exponent) {
    std::memmove(exponent + 1, exponent, static_cast<std::size_t>(end - exponent));
    *exponent = '.';
    ++end;
  }
  buffer_->advance(static_cast<std::size_t>(end - begin));
}

namespace {

// One code point from UTF-8; bytes that are no UTF-8 become U+FFFD.
char32_t next_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 0;
  if (length == 0 || length > text.size()) {
    text.remove_prefix(1);
    return U'\uFFFD';
  }
  char32_t code = length == 1 ? first : first & (0x7F >> length);
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3F);
  text.remove_prefix(length);
  return code;
}

}  // namespace

void StepText::argument(Quoted quoted) {
  std::string out = "'";
  for (std::string_view rest = quoted.text; !rest.empty();) {
    const char32_t code = next_code_point(rest);
    if (code == U'\'' || code == U'\\') {
      out.append(2, static_cast<char>(code));
    } else if (code >= 0x20 && code < 0x7F) {
      out += static_cast<char>(code);
    } else {
      constexpr std::string_view hex = "0123456789ABCDEF";
      out += "\\X4\\";
      for (int shift = 28; shift >= 0; shift -= 4) out += hex[code >> shift & 15];
      out += "\\X0\\";
    }
  }
  put(out + "'");
}

void StepText::argument(const Grid& grid) {
  put("(");
  const std::size_t count = std::max(grid.refs.size(), grid.reals.size());
  for (std::size_t start = 0; start < count; start += grid.columns) {
    if (start > 0) put(",\n");
    if (grid.refs.empty())
      list(grid.reals.subspan(start, grid.columns), [this](double x) { real(x); });
    else
      list(grid.refs.subspan(start, grid.columns), [this](StepId id) { argument(Ref{id}); });
  }
  put(")");
}

}  // namespace meso::step
