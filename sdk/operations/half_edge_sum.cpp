// SPDX-License-Identifier: Apache-2.0
#include "half_edge_sum.hpp"

#include <bit>
#include <map>

namespace meso::operations {
namespace {

using Corner = std::array<float, 3>;

Corner rounded(Vec3 p) {
  const auto real = [](double c) { return static_cast<float>(c) + 0.0F; };  // + 0: one zero, not two
  return {real(p.x), real(p.y), real(p.z)};
}

/// SplitMix64's last step (Steele, Lea and Flood, 2014), which any bit changes half of.
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

std::uint64_t hash_of(const Corner& a, const Corner& b, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const Corner* corner : {&a, &b})
    for (const float c : *corner) hash = mixed(hash + std::bit_cast<std::uint32_t>(c) + 0x9e3779b97f4a7c15u);
  return hash;
}

}  // namespace

void HalfEdgeSum::add(const Triangle& t) {
  const std::array<Corner, 3> corners{rounded(t[0]), rounded(t[1]), rounded(t[2])};
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner &a = corners[k], &b = corners[(k + 1) % 3];
    if (a == b) continue;
    for (std::size_t s = 0; s < 2; ++s) sums_[s] += a < b ? hash_of(a, b, s) : 0 - hash_of(b, a, s);
  }
}

std::uint64_t count_unmatched_half_edges(const TriangleStream& triangles) {
  std::map<std::array<Corner, 2>, std::int64_t> uses;  // forwards less backwards
  triangles([&](std::span<const Triangle> block) {
    for (const Triangle& t : block)
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner a = rounded(t[k]), b = rounded(t[(k + 1) % 3]);
        if (a == b) continue;
        const auto found = uses.try_emplace(a < b ? std::array{a, b} : std::array{b, a}, 0).first;
        found->second += a < b ? 1 : -1;
        if (found->second == 0) uses.erase(found);
      }
  });
  std::uint64_t unmatched = 0;
  for (const auto& [edge, count] : uses) unmatched += static_cast<std::uint64_t>(count < 0 ? -count : count);
  return unmatched;
}

}  // namespace meso::operations
