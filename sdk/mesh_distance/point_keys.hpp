// SPDX-License-Identifier: Apache-2.0
#pragma once
// 64 bits in place of a point's coordinates: equal points have equal keys, different points in practice never do. With
// them, loose corners can be compared without welding, and a mesh be found closed by one sum.

#include <bit>
#include <cstdint>

#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

/// The finaliser of splitmix64: every bit of the result depends on every bit of x.
[[nodiscard]] inline std::uint64_t scrambled(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

[[nodiscard]] inline std::uint64_t point_key(Vec3 p) {
  std::uint64_t key = 0x9e3779b97f4a7c15u;
  for (std::size_t i = 0; i < 3; ++i) key = scrambled(key + std::bit_cast<std::uint64_t>(p[i] + 0.0));  // -0 is 0
  return key;
}

/// Cancels with the same edge in the other direction, and with nothing else. Zero if both ends are one point.
[[nodiscard]] inline std::uint64_t edge_key(std::uint64_t a, std::uint64_t b) {
  if (a == b) return 0;
  return a < b ? scrambled(a ^ std::rotl(scrambled(b), 21)) : 0 - scrambled(b ^ std::rotl(scrambled(a), 21));
}

}  // namespace meso::implicit
