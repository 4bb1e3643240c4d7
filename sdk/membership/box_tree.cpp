// SPDX-License-Identifier: Apache-2.0
#include "box_tree.hpp"

#include <algorithm>

namespace meso::membership {

BoxTree::BoxTree(std::span<const Box3> boxes) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) numbers.push_back(i);
  if (numbers.empty()) return;
  nodes_.reserve(2 * numbers.size());
  nodes_.emplace_back();
  build(0, boxes, numbers);
}

void BoxTree::build(std::size_t node, std::span<const Box3> boxes, std::span<std::uint32_t> numbers) {
  for (const std::uint32_t n : numbers) nodes_[node].box = united(nodes_[node].box, boxes[n]);
  if (numbers.size() == 1) {
    nodes_[node].first = numbers.front();
    nodes_[node].is_leaf = true;
    return;
  }
  const Vec3 size = nodes_[node].box.max - nodes_[node].box.min;
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::ranges::nth_element(numbers, middle, {},
                           [&](std::uint32_t n) { return boxes[n].min[axis] + boxes[n].max[axis]; });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(children, boxes, {numbers.begin(), middle});
  build(children + 1, boxes, {middle, numbers.end()});
}

}  // namespace meso::membership
