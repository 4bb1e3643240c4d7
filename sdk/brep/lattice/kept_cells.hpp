// SPDX-License-Identifier: Apache-2.0
#pragma once
// The cells of a lattice that lie in the body, numbered in lexicographic order of their indices. Private.

#include <cstdint>
#include <vector>

#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

class KeptCells {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// Asks `set.inside` once for every index of the range.
  explicit KeptCells(const LatticeSet& set) : KeptCells({set.min, set.max, {}}, set.min, set.max, set.inside) {}
  /// Boxes `min` ... `max`, also such as the pattern's range leaves out; asks `kept` once for each. The pattern has the
  /// cells that are `inside` it, or all of its range.
  KeptCells(const LatticeSet& pattern, const Index3& min, const Index3& max, const std::function<bool(Index3)>& kept)
      : pattern_min_(pattern.min), pattern_max_(pattern.max), min_(min), max_(max) {
    for (std::size_t i = 0; i < 3; ++i) extent_[i] = static_cast<std::size_t>(std::max(0, max_[i] - min_[i] + 1));
    numbers_.assign(extent_[0] * extent_[1] * extent_[2], none);
    if (pattern.inside) {
      pattern_.resize(numbers_.size());
      std::size_t slot = 0;
      visit_boxes([&](const Index3& cell) {
        pattern_[slot++] = within(cell, pattern_min_, pattern_max_) && pattern.inside(cell);
      });
    }
    std::size_t slot = 0;
    visit_boxes([&](const Index3& cell) {
      if (kept(cell)) {
        numbers_[slot] = static_cast<std::uint32_t>(cells_.size());
        cells_.push_back(cell);
      }
      ++slot;
    });
  }

  /// Whether the pattern has that cell, kept or not.
  [[nodiscard]] bool in_pattern(const Index3& cell) const {
    if (pattern_.empty()) return within(cell, pattern_min_, pattern_max_);
    return within(cell, min_, max_) && pattern_[slot_of(cell)];
  }
  /// `none` where the cell is not kept.
  [[nodiscard]] std::uint32_t number(const Index3& cell) const {
    return within(cell, min_, max_) ? numbers_[slot_of(cell)] : none;
  }
  [[nodiscard]] const Index3& cell(std::uint32_t number) const { return cells_[number]; }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(cells_.size()); }

 private:
  template <typename Visit>
  void visit_boxes(const Visit& visit) const {
    for (Index3 cell = min_; cell[0] <= max_[0]; ++cell[0])
      for (cell[1] = min_[1]; cell[1] <= max_[1]; ++cell[1])
        for (cell[2] = min_[2]; cell[2] <= max_[2]; ++cell[2]) visit(cell);
  }
  [[nodiscard]] std::size_t slot_of(const Index3& cell) const {
    const auto at = [&](std::size_t i) { return static_cast<std::size_t>(cell[i] - min_[i]); };
    return (at(0) * extent_[1] + at(1)) * extent_[2] + at(2);
  }
  static bool within(const Index3& cell, const Index3& min, const Index3& max) {
    for (std::size_t i = 0; i < 3; ++i)
      if (cell[i] < min[i] || cell[i] > max[i]) return false;
    return true;
  }

  Index3 pattern_min_, pattern_max_, min_, max_;
  std::array<std::size_t, 3> extent_{};
  std::vector<bool> pattern_;  ///< by slot; empty: all of its range
  std::vector<std::uint32_t> numbers_;
  std::vector<Index3> cells_;
};

}  // namespace meso::brep
