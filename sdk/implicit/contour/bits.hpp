// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rows of bits, 64 to a word.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace meso::implicit {

/// Visits the positions of the bits that are set in word `w` of a row, ascending.
template <class Visit>
void for_each_bit(std::uint64_t bits, std::size_t w, Visit visit) {
  for (; bits != 0; bits &= bits - 1) visit(64 * w + static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Writes those positions from `to` on and returns where they end.
inline std::uint16_t* append_bits(std::uint64_t bits, std::size_t w, std::uint16_t* to) {
  for_each_bit(bits, w, [&](std::size_t i) { *to++ = static_cast<std::uint16_t>(i); });
  return to;
}

/// The word that has every bit of word `w` one place further: bit i is the row's bit i - 1. row[-1] may be read.
inline std::uint64_t moved_up(const std::uint64_t* row, std::size_t w) {
  const std::uint64_t* const word = row + w;
  return word[0] << 1 | word[-1] >> 63;
}

/// Bits b - 1 and b of a row. row[-1] may be read.
inline unsigned two_signs(const std::uint64_t* row, std::size_t b) {
  static_assert(std::endian::native == std::endian::little, "rows of bits are read byte by byte");
  const std::size_t bit = b + 63;
  std::uint32_t bits = 0;
  std::memcpy(&bits, reinterpret_cast<const char*>(row - 1) + bit / 8, sizeof bits);
  return bits >> bit % 8 & 3U;
}

}  // namespace meso::implicit
