// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles in ranges that several threads may visit at once.
//
//   for (std::size_t range = 0; range < ranges.count; ++range) ranges.visit(range, callback);   // all, in order

#include "meso/base/triangle_stream.hpp"

namespace meso {

struct TriangleRanges {
  std::size_t count = 0;
  /// Calls back the triangles of one range, always the same in the same order.
  std::function<void(std::size_t range, const TriangleBlockCallback&)> visit;
};

}  // namespace meso
