// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which of many boxes contain a point: a tree of boxes, halved at the median of the longest side. Private.

#include <cstdint>
#include <span>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::membership {

/// Stands for "anywhere", and can be turned and added to without overflow.
inline constexpr double anywhere_mm = 1e30;
inline constexpr Box3 anywhere{{-anywhere_mm, -anywhere_mm, -anywhere_mm}, {anywhere_mm, anywhere_mm, anywhere_mm}};

[[nodiscard]] inline bool holds(const Box3& box, Vec3 p) {
  return p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y && p.y <= box.max.y && p.z >= box.min.z &&
         p.z <= box.max.z;
}
[[nodiscard]] inline Box3 united(Box3 a, const Box3& b) {
  if (b.empty()) return a;
  a.extend(b.min);
  a.extend(b.max);
  return a;
}
[[nodiscard]] inline Box3 common(const Box3& a, const Box3& b) {
  if (a.empty() || b.empty() || !a.intersects(b)) return {};
  Box3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.min[i] = std::fmax(a.min[i], b.min[i]);
    out.max[i] = std::fmin(a.max[i], b.max[i]);
  }
  return out;
}

class BoxTree {
 public:
  explicit BoxTree(std::span<const Box3> boxes);

  /// Calls back the numbers of the boxes that contain p; the callback's false ends the visit.
  template <class Callback>
  void visit(Vec3 p, Callback callback) const {
    if (nodes_.empty()) return;
    std::uint32_t open[64];  // a median tree of 2^32 boxes is 32 deep
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[open[--count]];
      if (!holds(node.box, p)) continue;
      if (node.is_leaf) {
        if (!callback(node.first)) return;
        continue;
      }
      open[count++] = node.first;
      open[count++] = node.first + 1;
    }
  }
  [[nodiscard]] Box3 box() const { return nodes_.empty() ? Box3{} : nodes_.front().box; }

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0;  ///< the box's number, or the first of two children
    bool is_leaf = false;
  };
  void build(std::size_t node, std::span<const Box3> boxes, std::span<std::uint32_t> numbers);

  std::vector<Node> nodes_;
};

}  // namespace meso::membership
