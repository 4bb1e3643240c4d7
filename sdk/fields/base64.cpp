// SPDX-License-Identifier: Apache-2.0
// Four table look-ups and three stores for a group of four letters: the tables hold the letters' bits where they belong
// in the 24-bit group, so that one test finds any letter that is none of the alphabet.
#include "meso/fields/base64.hpp"

#include <array>
#include <cstdint>
#include <cstring>

namespace meso::fields {
namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint32_t no_letter = 0x8000'0000;

using LetterBits = std::array<std::uint32_t, 256>;

/// Bits of a letter at position `place` of its group, as the bytes of a little-endian word.
constexpr LetterBits letter_bits(int place) {
  LetterBits table{};
  for (auto& entry : table) entry = no_letter;
  for (std::uint32_t value = 0; value < 64; ++value) {
    const std::uint32_t group = value << (18 - 6 * place);
    table[static_cast<unsigned char>(alphabet[value])] = (group >> 16 & 0xFF) | (group & 0xFF00) | (group & 0xFF) << 16;
  }
  return table;
}
constexpr LetterBits first = letter_bits(0), second = letter_bits(1), third = letter_bits(2), fourth = letter_bits(3);

std::uint32_t group_at(const unsigned char* p) { return first[p[0]] | second[p[1]] | third[p[2]] | fourth[p[3]]; }

bool is_space(unsigned char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

}  // namespace

std::optional<std::size_t> decode_base64(std::string_view text, std::byte* out) {
  const auto* p = reinterpret_cast<const unsigned char*>(text.data());
  const unsigned char* const end = p + text.size();
  std::byte* const begin = out;
  std::array<unsigned char, 4> group{};
  std::size_t held = 0, padding = 0;
  while (p != end) {
    // Whole groups; there is room for the word's fourth byte, which the next group overwrites.
    while (held == 0 && padding == 0 && end - p >= 4) {
      const std::uint32_t bits = group_at(p);
      if ((bits & no_letter) != 0) break;
      std::memcpy(out, &bits, 4);
      out += 3;
      p += 4;
    }
    if (p == end) break;
    const unsigned char c = *p++;
    if (is_space(c)) continue;
    if (c == '=') {
      if (held + padding < 2 || held + padding > 3) return std::nullopt;
      ++padding;
    } else {
      if (padding > 0 || first[c] == no_letter) return std::nullopt;
      group[held++] = c;
      if (held == 4) {
        const std::uint32_t bits = group_at(group.data());
        std::memcpy(out, &bits, 3);
        out += 3;
        held = 0;
      }
    }
  }
  if (held + padding != 0 && held + padding != 4) return std::nullopt;
  if (held != 0) {
    for (std::size_t i = held; i < 4; ++i) group[i] = 'A';
    const std::uint32_t bits = group_at(group.data());
    std::memcpy(out, &bits, held - 1);
    out += held - 1;
  }
  return static_cast<std::size_t>(out - begin);
}

std::string encode_base64(const std::byte* bytes, std::size_t size) {
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = size - i;
    const auto byte = [&](std::size_t k) { return k < left ? static_cast<std::uint32_t>(bytes[i + k]) : 0U; };
    const std::uint32_t group = byte(0) << 16 | byte(1) << 8 | byte(2);
    text += alphabet[group >> 18];
    text += alphabet[group >> 12 & 63];
    text += left > 1 ? alphabet[group >> 6 & 63] : '=';
    text += left > 2 ? alphabet[group & 63] : '=';
  }
  return text;
}

}  // namespace meso::fields
