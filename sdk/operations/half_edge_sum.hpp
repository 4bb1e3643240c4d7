// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does every half-edge of a mesh meet its opposite? In constant memory, for any number of triangles. Private.
//
//   HalfEdgeSum sum;
//   for (const Triangle& t : block) sum.add(t);
//   if (!sum.is_balanced()) ...   // a hole, a flipped triangle, points that should be equal and are not
//
// Corners are rounded as binary STL does. Each directed edge adds a hash of its two ends, and the opposite one takes it
// away: what is left is zero where all meet, and elsewhere with a probability of 2^-128.

#include <array>
#include <cstdint>

#include "meso/base/triangle_stream.hpp"

namespace meso::operations {

class HalfEdgeSum {
 public:
  void add(const Triangle& t);
  [[nodiscard]] bool is_balanced() const { return sums_[0] == 0 && sums_[1] == 0; }

 private:
  std::array<std::uint64_t, 2> sums_{};
};

/// How many half-edges have no opposite, counted one by one: 100 bytes a triangle.
[[nodiscard]] std::uint64_t count_unmatched_half_edges(const TriangleStream& triangles);

}  // namespace meso::operations
