// SPDX-License-Identifier: Apache-2.0
#pragma once
// How many cells of a pattern a set of boxes is in: a cell may have several boxes, and some stand beyond the pattern's
// rim, where only what its outermost cells send over it is. Private.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

class CellsOfBoxes {
 public:
  /// Boxes (0, 0, 0) ... `last`; `block`: those of one cell along each axis.
  CellsOfBoxes(const Index3& last, const Index3& block) : block_(block) {
    for (std::size_t a = 0; a < 3; ++a) cells_[a] = static_cast<std::size_t>(last[a] / block[a] + 1);
    known_.assign(cells_[0] * cells_[1] * cells_[2], false);
  }
  /// Each box once.
  void add(const Index3& box) {
    std::size_t at = 0;
    for (std::size_t a = 0; a < 3; ++a)  // what stands beyond the rim is of the cells there
      at = at * cells_[a] + std::min(static_cast<std::size_t>(std::max(box[a], 0) / block_[a]), cells_[a] - 1);
    if (known_[at]) return;
    known_[at] = true;
    ++count_;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  Index3 block_;
  std::array<std::size_t, 3> cells_{};
  std::vector<bool> known_;
  std::uint64_t count_ = 0;
};

}  // namespace meso::brep
