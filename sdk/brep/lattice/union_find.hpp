// SPDX-License-Identifier: Apache-2.0
#pragma once
// Disjoint sets of 0 .. n-1; the smallest member names its set.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace meso::brep {

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  [[nodiscard]] std::uint32_t root(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace meso::brep
