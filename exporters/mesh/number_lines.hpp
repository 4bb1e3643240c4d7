// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lines of three numbers with fixed text around them, as all text formats of meshes have them.

#include <array>
#include <charconv>
#include <span>
#include <string_view>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/vec.hpp"

namespace meso {

/// What stands before each of the three numbers, and behind the last.
using LineText = std::array<std::string_view, 4>;

template <class Number>
void put_line(const LineText& text, const std::array<Number, 3>& numbers, ByteBuffer& out) {
  constexpr std::size_t longest_number = 24;
  std::size_t most = 3 * longest_number;
  for (const std::string_view part : text) most += part.size();
  char* const begin = out.claim(most);
  char* to = begin;
  for (std::size_t i = 0; i < 3; ++i) {
    to += text[i].copy(to, text[i].size());
    to = std::to_chars(to, to + longest_number, numbers[i]).ptr;
  }
  to += text[3].copy(to, text[3].size());
  out.advance(static_cast<std::size_t>(to - begin));
}

template <class Real>
void put_points(const LineText& text, std::span<const Vec3> block, ByteBuffer& out) {
  const auto real = [](double c) { return static_cast<Real>(c) + Real{0}; };  // + 0: one zero, not two
  for (const Vec3& p : block) put_line(text, std::array{real(p.x), real(p.y), real(p.z)}, out);
}

}  // namespace meso
