// SPDX-License-Identifier: Apache-2.0
#include "tree_builder.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace meso::implicit {
namespace {

constexpr std::size_t most_bins = 16;
constexpr std::uint32_t leaf_triangles = 4;
constexpr std::size_t parallel_leaves = 4096;
constexpr std::uint32_t leaf_block = 1 << 14;  // triangles whose leaves are made by one thread

}  // namespace

TreeBuilder::Box TreeBuilder::box_of(const Triangle& t) const {
  Box box;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [least, most] = std::minmax({t[0][i], t[1][i], t[2][i]});
    const auto low = static_cast<float>(unit_ * (least - middle_[i]));
    const auto high = static_cast<float>(unit_ * (most - middle_[i]));
    constexpr float outward = 2.4e-7f;  // two units in the last place
    box.low[i] = low - (outward * std::abs(low) + 1e-30f);
    box.high[i] = high + (outward * std::abs(high) + 1e-30f);
  }
  return box;
}

/// Greedy: a leaf takes the next triangle as long as its box stays as small as boxes of their own would be.
void TreeBuilder::make_leaves(std::uint32_t first, std::uint32_t last, std::vector<Leaf>& out) const {
  constexpr float most_growth = 1.5f;
  while (first < last) {
    Box box = box_of(triangles_[first]);
    float apart = box.half_area();
    std::uint32_t count = 1;
    for (; count < leaf_triangles && first + count < last; ++count) {
      const Box next = box_of(triangles_[first + count]);
      Box both = box;
      both.extend(next);
      apart += next.half_area();
      if (both.half_area() > most_growth * apart) break;
      box = both;
    }
    out.push_back({box, TriangleTree::Node::leaf | (count - 1) << TriangleTree::Node::count_shift | first});
    first += count;
  }
}

void TreeBuilder::make_leaves() {
  const auto size = static_cast<std::uint32_t>(triangles_.size());
  std::vector<std::vector<Leaf>> blocks((size + leaf_block - 1) / leaf_block);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    if (stop_()) return;
    const auto first = static_cast<std::uint32_t>(b) * leaf_block;
    blocks[b].reserve(leaf_block / 3);
    make_leaves(first, std::min(size, first + leaf_block), blocks[b]);
  });
  for (const std::vector<Leaf>& block : blocks) leaves_.insert(leaves_.end(), block.begin(), block.end());
}

TreeBuilder::Box TreeBuilder::box_of(Range leaves) {
  Box box;
  for (const Leaf& leaf : leaves) box.extend(leaf.box);
  return box;
}

/// How many leaves go to the first half; they are moved to the front.
std::size_t TreeBuilder::part(Range leaves, std::size_t depth) {
  Box middles;
  for (const Leaf& leaf : leaves) middles.extend({leaf.middle2(), leaf.middle2()});
  const Lanes low = middles.low, high = middles.high;
  std::size_t axis = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
  }
  const std::size_t bins = std::min(most_bins, leaves.size());
  const float scale = static_cast<float>(bins) / (high[axis] - low[axis]);
  if (depth > max_depth / 2 || !(scale < HUGE_VALF)) return leaves.size() / 2;
  const auto bin_of = [&](const Leaf& leaf) {
    return std::min(bins - 1, static_cast<std::size_t>((leaf.middle2()[axis] - low[axis]) * scale));
  };
  std::array<Box, most_bins> boxes;
  std::array<std::uint32_t, most_bins> counts{};
  for (const Leaf& leaf : leaves) {
    const std::size_t b = bin_of(leaf);
    boxes[b].extend(leaf.box);
    ++counts[b];
  }
  // Cost of parting before bin b: area times number on both sides.
  std::array<float, most_bins> before{};
  Box box;
  float number = 0;
  for (std::size_t b = 0; b + 1 < bins; ++b) {
    box.extend(boxes[b]);
    number += static_cast<float>(counts[b]);
    before[b + 1] = number > 0 ? number * box.half_area() : 0;
  }
  box = {};
  number = 0;
  float least = HUGE_VALF;
  std::size_t best = 0;
  for (std::size_t b = bins - 1; b > 0; --b) {
    box.extend(boxes[b]);
    number += static_cast<float>(counts[b]);
    const float cost = before[b] + (number > 0 ? number * box.half_area() : 0);
    if (number > 0 && cost < least) least = cost, best = b;
  }
  const auto middle = std::partition(leaves.begin(), leaves.end(), [&](const Leaf& l) { return bin_of(l) < best; });
  const auto size = static_cast<std::size_t>(middle - leaves.begin());
  return size == 0 || size == leaves.size() ? leaves.size() / 2 : size;
}

/// Between which planes the triangles of a leaf lie; all of space for other children.
void TreeBuilder::set_planes(TriangleTree::Node& node, std::size_t slot) const {
  const std::uint32_t child = node.child[slot];
  Vec3 normal;
  std::span<const Triangle> triangles;
  if ((child & TriangleTree::Node::leaf) != 0) {
    const std::uint32_t count = ((child & ~TriangleTree::Node::leaf) >> TriangleTree::Node::count_shift) + 1;
    triangles = triangles_.subspan(child & TriangleTree::Node::first_mask, count);
    for (const Triangle& t : triangles) normal += cross(unit_ * (t[1] - t[0]), unit_ * (t[2] - t[0]));
  }
  const double length = norm(normal);
  const bool has_planes = length > 1e-30 && length < HUGE_VAL;
  std::array<float, 3> n{};
  for (std::size_t axis = 0; axis < 3 && has_planes; ++axis)
    n[axis] = static_cast<float>((1 - 1e-6) / length * normal[axis]);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Triangle& t : triangles) {
    for (const Vec3& corner : t) {
      const Vec3 p = unit_ * (corner - middle_);
      const double along = n[0] * p.x + n[1] * p.y + n[2] * p.z;
      low = std::min(low, along);
      high = std::max(high, along);
    }
  }
  constexpr float outward = 2.4e-7f;
  for (std::size_t axis = 0; axis < 3; ++axis) node.normal[axis][slot] = n[axis];
  const auto behind = static_cast<float>(low), before = static_cast<float>(high);
  node.behind[slot] = has_planes ? behind - (outward * std::abs(behind) + 1e-30f) : -HUGE_VALF;
  node.before[slot] = has_planes ? before + (outward * std::abs(before) + 1e-30f) : HUGE_VALF;
}

/// A node of n leaves and all below it have numbers from `number` to `number` + n - 1: known before they are built, so
/// that threads need not wait for each other and numbers do not depend on them.
void TreeBuilder::build_node(Range leaves, std::size_t number, std::size_t depth) {
  if (leaves.size() > parallel_leaves && stop_()) return;
  std::array<Range, 4> parts{leaves};
  std::size_t count = 1;
  for (; leaves.size() <= 4 && count < leaves.size(); ++count) {
    parts[count] = parts[count - 1].subspan(1);
    parts[count - 1] = parts[count - 1].first(1);
  }
  while (leaves.size() > 4 && count < 4) {
    const auto largest = std::max_element(parts.begin(), parts.begin() + count,
                                          [](const Range& a, const Range& b) { return a.size() < b.size(); });
    const Range whole = *largest;  // more than one leaf: five or more are in fewer than four parts
    const std::size_t front = part(whole, depth);
    *largest = whole.first(front);
    parts[count++] = whole.subspan(front);
  }
  std::array<std::size_t, 4> child_number{};
  TriangleTree::Node& node = nodes_[number];
  std::size_t next = number + 1;
  for (std::size_t i = 0; i < 4; ++i) {
    const Box box = i < count ? box_of(parts[i]) : Box{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.low[axis][i] = box.low[axis];
      node.high[axis][i] = box.high[axis];
    }
    node.child[i] = 0;
    set_planes(node, i);
    if (i >= count) continue;
    child_number[i] = next;
    node.child[i] = parts[i].size() == 1 ? parts[i][0].child : static_cast<std::uint32_t>(next);
    set_planes(node, i);
    next += parts[i].size() - 1;
  }
  const auto build_child = [&](std::size_t i) {
    if (parts[i].size() > 1) build_node(parts[i], child_number[i], depth + 1);
  };
  if (leaves.size() > parallel_leaves) {
    tbb::parallel_for(std::size_t{0}, count, build_child);
  } else {
    for (std::size_t i = 0; i < count; ++i) build_child(i);
  }
}

/// Parents before their children, without the numbers that were reserved and not used.
std::uint32_t TreeBuilder::move_node(std::uint32_t number, std::vector<TriangleTree::Node>& out) const {
  const auto moved = static_cast<std::uint32_t>(out.size());
  out.push_back(nodes_[number]);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t child = nodes_[number].child[i];
    if ((child & TriangleTree::Node::leaf) == 0 && child != 0) out[moved].child[i] = move_node(child, out);
  }
  return moved;
}

std::vector<TriangleTree::Node> TreeBuilder::build() {
  make_leaves();
  if (stop_.stopped()) return {};
  nodes_.reset(new TriangleTree::Node[leaves_.size()]);  // not make_unique: it would write them all
  build_node(leaves_, 0, 0);
  if (stop_.stopped()) return {};
  std::vector<TriangleTree::Node> out;
  out.reserve(leaves_.size() / 2 + 1);
  (void)move_node(0, out);
  return out;
}

}  // namespace meso::implicit
