// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which of many boxes meet? Found with a uniform grid, so that a hundred thousand boxes are not compared pair by pair.
//
//   visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) { ... });   // i < k, each pair once
//
// The grid is as wide as the average box; the few that would cover more than `most_grid_cells` of its cells are
// compared with all. The order of the pairs depends on nothing but the boxes. About 0.2 us a box and pair. Private.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::brep {

class BoxGrid {
 public:
  explicit BoxGrid(std::span<const Box3> boxes) : boxes_(boxes) {
    Box3 all;
    double sum = 0;
    std::size_t count = 0;
    for (const Box3& box : boxes) {
      if (box.empty()) continue;
      all.extend(box.min);
      all.extend(box.max);
      sum += std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
      ++count;
    }
    origin_ = all.min;
    // At most 2^20 grid cells along an axis: a key is 63 bits.
    for (std::size_t a = 0; count > 0 && a < 3; ++a)
      width_ = std::max(width_, (all.max[a] - all.min[a]) / static_cast<double>(1 << 20));
    if (count > 0) width_ = std::max({width_, sum / static_cast<double>(count), 1e-9});
    for (std::size_t i = 0; i < boxes.size(); ++i)
      if (!boxes[i].empty()) insert(i);
    std::ranges::sort(entries_);
  }

  template <typename Visit>
  void visit_meeting_pairs(Visit visit) const {
    for (std::size_t begin = 0, end = 0; begin < entries_.size(); begin = end) {
      while (end < entries_.size() && entries_[end].key == entries_[begin].key) ++end;
      for (std::size_t a = begin; a < end; ++a)
        for (std::size_t b = a + 1; b < end; ++b) {
          const std::size_t i = entries_[a].box, k = entries_[b].box;
          // Pairs that share several grid cells belong to the one with the corner where both have begun.
          if (boxes_[i].intersects(boxes_[k]) && key_of(larger(boxes_[i].min, boxes_[k].min)) == entries_[a].key)
            visit(i, k);
        }
    }
    for (const std::size_t i : large_)
      for (std::size_t k = 0; k < boxes_.size(); ++k) {
        const bool later = k > i || !std::ranges::binary_search(large_, k);  // two large ones meet once
        if (k != i && later && boxes_[i].intersects(boxes_[k])) visit(std::min(i, k), std::max(i, k));
      }
  }

 private:
  static constexpr std::uint64_t most_grid_cells = 64;
  using GridIndex = std::array<std::uint64_t, 3>;
  struct Entry {
    std::uint64_t key = 0;
    std::size_t box = 0;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };

  static Vec3 larger(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
  [[nodiscard]] GridIndex index_of(Vec3 p) const {
    GridIndex out{};
    for (std::size_t a = 0; a < 3; ++a) out[a] = static_cast<std::uint64_t>((p[a] - origin_[a]) / width_);
    return out;
  }
  static std::uint64_t key_of(const GridIndex& i) { return i[0] << 42 | i[1] << 21 | i[2]; }
  [[nodiscard]] std::uint64_t key_of(Vec3 p) const { return key_of(index_of(p)); }

  void insert(std::size_t box) {
    const GridIndex low = index_of(boxes_[box].min), high = index_of(boxes_[box].max);
    std::uint64_t covered = 1;
    for (std::size_t a = 0; a < 3; ++a) covered *= std::min(high[a] - low[a] + 1, most_grid_cells + 1);
    if (covered > most_grid_cells) {
      large_.push_back(box);
      return;
    }
    for (std::uint64_t x = low[0]; x <= high[0]; ++x)
      for (std::uint64_t y = low[1]; y <= high[1]; ++y)
        for (std::uint64_t z = low[2]; z <= high[2]; ++z) entries_.push_back({key_of(GridIndex{x, y, z}), box});
  }

  std::span<const Box3> boxes_;
  Vec3 origin_;
  double width_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::size_t> large_;  ///< ascending
};

template <typename Visit>
void visit_meeting_pairs(std::span<const Box3> boxes, Visit visit) {
  BoxGrid(boxes).visit_meeting_pairs(visit);
}

}  // namespace meso::brep
