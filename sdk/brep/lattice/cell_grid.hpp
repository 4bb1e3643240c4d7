// SPDX-License-Identifier: Apache-2.0
#pragma once
// The boxes of a lattice that a body can meet, as a block of integers. Private.

#include <algorithm>
#include <cstdint>

#include "meso/brep/body.hpp"

namespace meso::brep {

struct CellGrid {
  Box3 first;           ///< the box of cell (0, 0, 0)
  Index3 min{}, max{};  ///< inclusive
  double tolerance = 0;

  [[nodiscard]] Vec3 size() const { return first.max - first.min; }
  [[nodiscard]] std::size_t extent(std::size_t axis) const {
    return static_cast<std::size_t>(std::max(0, max[axis] - min[axis] + 1));
  }
  [[nodiscard]] std::size_t count() const { return extent(0) * extent(1) * extent(2); }
  /// Lexicographic.
  [[nodiscard]] std::size_t slot(const Index3& cell) const {
    const auto at = [&](std::size_t i) { return static_cast<std::size_t>(cell[i] - min[i]); };
    return (at(0) * extent(1) + at(1)) * extent(2) + at(2);
  }
  [[nodiscard]] Vec3 origin(const Index3& cell) const {
    return {first.min.x + cell[0] * size().x, first.min.y + cell[1] * size().y, first.min.z + cell[2] * size().z};
  }
  [[nodiscard]] Vec3 centre(const Index3& cell) const { return origin(cell) + 0.5 * size(); }

  [[nodiscard]] bool has(const Index3& cell) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (cell[i] < min[i] || cell[i] > max[i]) return false;
    return true;
  }

  /// Visits, in lexicographic order, the cells whose closed boxes grown by `by` meet `box`.
  template <typename Visit>
  void visit_near(const Box3& box, double by, Visit visit) const {
    Index3 low, high;
    for (std::size_t i = 0; i < 3; ++i) {
      const double from = std::floor((box.min[i] - by - first.min[i]) / size()[i]);
      const double to = std::floor((box.max[i] + by - first.min[i]) / size()[i]);
      // One more on the low side: its high wall may be what is met.
      low[i] = static_cast<std::int32_t>(std::max(from - 1, static_cast<double>(min[i])));
      high[i] = static_cast<std::int32_t>(std::min(to + 1, static_cast<double>(max[i])));
      if (low[i] > high[i]) return;
    }
    for (Index3 cell = low; cell[0] <= high[0]; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) visit(cell);
  }
};

/// Of the triangles of what is in a box.
[[nodiscard]] inline double deflection_in(const CellGrid& grid) {
  return 0.01 * std::min({grid.size().x, grid.size().y, grid.size().z});
}

}  // namespace meso::brep
