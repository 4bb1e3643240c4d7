// SPDX-License-Identifier: Apache-2.0
#include "triangle_tree.hpp"

#include <algorithm>

#include "closest_point.hpp"
#include "tree_builder.hpp"

namespace meso::implicit {
namespace {

using Node = TriangleTree::Node;

/// Nodes to visit, nearest last. A tree of 2^29 triangles is at most 64 levels deep, three siblings wait on each.
template <class Entry>
class Stack {
 public:
  void push(Entry e) { entries_[size_++] = e; }
  Entry pop() { return entries_[--size_]; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  std::array<Entry, 3 * TreeBuilder::max_depth + 4> entries_;
  std::size_t size_ = 0;
};

struct Candidate {
  double squared_distance;
  std::uint32_t child;
};

std::array<double, 4> squared_distances(const Node& node, Vec3 p) {
  std::array<double, 4> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = p[axis];
    for (std::size_t i = 0; i < 4; ++i) {
      const double below = node.low[axis][i] - x, above = x - node.high[axis][i];
      const double beside = std::max(std::max(below, above), 0.0);
      out[i] += beside * beside;
    }
  }
  return out;
}

double square(double x) { return x * x; }

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles, const Box3& box, StopPoll& stop)
    : triangles_(std::move(triangles)), box_(box), middle_(0.5 * box.min + 0.5 * box.max) {
  const Vec3 half = 0.5 * box.max - 0.5 * box.min;
  const double largest = std::max({half.x, half.y, half.z});
  if (largest > 0) unit_ = std::exp2(-1 - std::ilogb(largest));
  nodes_ = TreeBuilder(triangles_, middle_, unit_, stop).build();
}

TriangleTree::Nearest TriangleTree::nearest(Vec3 p, std::uint32_t hint) const {
  const Vec3 q = to_unit(p);
  // Rounding in what a triangle or a box says about its distance stays below this. A box is skipped only if it is
  // farther than the best triangle by more, so that the best one is found from every beginning.
  const double slack = 1e-14 * (std::abs(q.x) + std::abs(q.y) + std::abs(q.z) + 2);
  Nearest best;
  double limit = HUGE_VAL;
  const auto try_triangle = [&](std::uint32_t i) {
    const Vec3 offset = to_closest_point(triangles_[i], p);
    const double d2 = dot(offset, offset);
    if (!(d2 < best.squared_distance)) return;
    best = {d2, offset, i};
    limit = square(unit_ * std::sqrt(d2) + slack);
  };
  if (hint < triangles_.size()) try_triangle(hint);

  Stack<Candidate> stack;
  stack.push({0, 0});
  while (!stack.empty()) {
    const Candidate next = stack.pop();
    if (next.squared_distance > limit) continue;
    if ((next.child & Node::leaf) != 0) {
      const std::uint32_t first = next.child & Node::first_mask;
      const std::uint32_t last = first + ((next.child & ~Node::leaf) >> Node::count_shift);
      for (std::uint32_t i = first; i <= last; ++i) try_triangle(i);
      continue;
    }
    const Node& node = nodes_[next.child];
    const std::array<double, 4> distances = squared_distances(node, q);
    std::array<Candidate, 4> children;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(distances[i] <= limit)) continue;
      std::size_t at = count++;
      for (; at > 0 && children[at - 1].squared_distance < distances[i]; --at) children[at] = children[at - 1];
      children[at] = {distances[i], node.child[i]};
    }
    for (std::size_t i = 0; i < count; ++i) stack.push(children[i]);
  }
  return best;
}

Winding TriangleTree::winding(Vec3 p) const {
  Winding out;
  const Vec3 q = to_unit(p);
  // Outward rounding of the boxes is a thousand times this.
  const double slack = 1e-15 * (std::abs(q.x) + std::abs(q.y) + std::abs(q.z) + 2);
  Stack<std::uint32_t> stack;
  stack.push(0);
  while (!stack.empty()) {
    const std::uint32_t next = stack.pop();
    if ((next & Node::leaf) == 0) {
      const Node& node = nodes_[next];
      for (std::size_t i = 0; i < 4; ++i) {
        const bool met = q.x <= node.high[0][i] + slack && q.y >= node.low[1][i] - slack &&
                         q.y <= node.high[1][i] + slack && q.z >= node.low[2][i] - slack &&
                         q.z <= node.high[2][i] + slack;
        if (met) stack.push(node.child[i]);
      }
      continue;
    }
    const std::uint32_t first = next & Node::first_mask;
    const std::uint32_t last = first + ((next & ~Node::leaf) >> Node::count_shift);
    for (std::uint32_t i = first; i <= last; ++i) {
      const Triangle& t = triangles_[i];
      const RayView view = view_along_x(t, p.y, p.z);
      const int side = view.crossing != 0 ? side_sign(t, p) : 0;
      if (view.crossing * side < 0) out.number += view.crossing;  // beyond p
      const bool may_touch = view.touches || (view.crossing != 0 && side == 0);
      if (may_touch && is_on(t, p)) out.on_surface = true;
    }
  }
  return out;
}

}  // namespace meso::implicit
