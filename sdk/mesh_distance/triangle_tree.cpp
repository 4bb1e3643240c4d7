// SPDX-License-Identifier: Apache-2.0
#include "triangle_tree.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <ranges>

#include "meso/mesh/closest_point.hpp"
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

using Float4 [[gnu::vector_size(16)]] = float;

Float4 load(const std::array<float, 4>& x) {
  Float4 out;
  std::memcpy(&out, x.data(), sizeof out);
  return out;
}
Float4 larger(Float4 a, Float4 b) { return a > b ? a : b; }

/// Good to 5e-7 of the point's distance from the middle of the mesh.
std::array<float, 4> squared_distances(const Node& node, const std::array<float, 3>& p) {
  Float4 sum{}, along{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Float4 beside = larger(larger(load(node.low[axis]) - p[axis], p[axis] - load(node.high[axis])), Float4{});
    sum += beside * beside;
    along += load(node.normal[axis]) * p[axis];
  }
  const Float4 off_planes = larger(larger(load(node.behind) - along, along - load(node.before)), Float4{});
  return std::bit_cast<std::array<float, 4>>(larger(sum, off_planes * off_planes));
}

/// For points so far away that floats would not tell one box from another.
std::array<double, 4> squared_distances(const Node& node, Vec3 p) {
  std::array<double, 4> sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double beside = std::max({node.low[axis][i] - p[axis], p[axis] - node.high[axis][i], 0.0});
      sum[i] += beside * beside;
    }
  }
  return sum;
}

std::array<float, 3> to_floats(Vec3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// How far a ray along x is from each child: the largest of what it lacks along y and z, and of how far the child is
/// behind its beginning.
std::array<float, 4> ray_distances(const Node& node, const std::array<float, 3>& p, int direction) {
  Float4 most = direction > 0 ? p[0] - load(node.high[0]) : load(node.low[0]) - p[0];
  for (std::size_t axis = 1; axis < 3; ++axis)
    most = larger(most, larger(load(node.low[axis]) - p[axis], p[axis] - load(node.high[axis])));
  return std::bit_cast<std::array<float, 4>>(most);
}

void meet(const Triangle& t, Vec3 p, int direction, Winding& winding) {
  const RayView view = view_along_x(t, p.y, p.z);
  const int side = view.crossing != 0 ? side_sign(t, p) : 0;
  // The normal points along x if the crossing is 1, so that p is on its side if p is beyond the triangle.
  if (view.crossing * side * direction < 0) winding.number += direction * view.crossing;
  const bool may_touch = view.touches || (view.crossing != 0 && side == 0);
  if (may_touch && is_on(t, p)) winding.on_surface = true;
}

/// The triangles of a child that is a leaf.
auto triangles_of(std::uint32_t child) {
  const std::uint32_t first = child & Node::first_mask;
  return std::views::iota(first, first + ((child & ~Node::leaf) >> Node::count_shift) + 1);
}

double size_of(Vec3 p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); }

double square(double x) { return x * x; }

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles, const Box3& box, StopPoll& stop)
    : triangles_(std::move(triangles)), box_(box), middle_(0.5 * box.min + 0.5 * box.max) {
  const Vec3 half = 0.5 * box.max - 0.5 * box.min;
  const double largest = std::max({half.x, half.y, half.z});
  if (largest > 0) unit_ = std::exp2(-1 - std::ilogb(largest));
  nodes_ = TreeBuilder(triangles_, middle_, unit_, stop).build();
}

/// Triangle by triangle, the best one so far; and how far, in units of the tree, a box may be to hold a better one.
class TriangleTree::Best {
 public:
  /// `slack`: rounding in what boxes say about their distance. A box is skipped only if it is farther than the best
  /// triangle by more, so that the best one is found from every beginning.
  Best(const TriangleTree& tree, Vec3 p, double within, double slack)
      : tree_(tree), p_(p), slack_(slack), limit_(square(tree.unit_ * within + slack)) {}

  void consider(std::uint32_t triangle) {
    const Vec3 offset = to_closest_point(tree_.triangles_[triangle], p_);
    const double d2 = dot(offset, offset);
    if (!(d2 < nearest_.squared_distance)) return;
    nearest_ = {d2, offset, triangle};
    limit_ = std::min(limit_, square(tree_.unit_ * std::sqrt(d2) + slack_));
  }
  [[nodiscard]] double limit() const { return limit_; }
  [[nodiscard]] const Nearest& nearest() const { return nearest_; }

 private:
  const TriangleTree& tree_;
  Vec3 p_;
  double slack_, limit_;
  Nearest nearest_;
};

/// `q`: the point as squared_distances takes it.
template <class Query>
void TriangleTree::search(const Query& q, Best& best) const {
  Stack<Candidate> stack;
  stack.push({0, 0});
  while (!stack.empty()) {
    const Candidate next = stack.pop();
    if (next.squared_distance > best.limit()) continue;
    if ((next.child & Node::leaf) != 0) {
      for (const std::uint32_t t : triangles_of(next.child)) best.consider(t);
      continue;
    }
    const Node& node = nodes_[next.child];
    const auto distances = squared_distances(node, q);
    std::array<Candidate, 4> children;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(distances[i] <= best.limit())) continue;
      std::size_t at = count++;
      for (; at > 0 && children[at - 1].squared_distance < distances[i]; --at) children[at] = children[at - 1];
      children[at] = {distances[i], node.child[i]};
    }
    for (std::size_t i = 0; i < count; ++i) stack.push(children[i]);
  }
}

TriangleTree::Nearest TriangleTree::nearest(Vec3 p, std::uint32_t hint, double within) const {
  const Vec3 q = to_unit(p);
  const bool far = size_of(q) > 100;
  Best best(*this, p, within, (far ? 1e-14 : 5e-7) * (size_of(q) + 2));
  if (hint < triangles_.size()) best.consider(hint);
  if (far)
    search(q, best);
  else
    search(to_floats(q), best);
  return best.nearest();
}

std::vector<Vec3> TriangleTree::normals_at(Vec3 p) const {
  constexpr std::size_t most = 8;
  std::vector<Vec3> normals;
  const Vec3 q = to_unit(p);
  const std::array<float, 3> f = to_floats(q);
  const double slack = 5e-7 * (size_of(q) + 2);
  Stack<std::uint32_t> stack;
  stack.push(0);
  while (!stack.empty() && normals.size() < most) {
    const std::uint32_t next = stack.pop();
    if ((next & Node::leaf) != 0) {
      for (const std::uint32_t t : triangles_of(next)) {
        const auto& [a, b, c] = triangles_[t];
        const Vec3 normal = cross(unit_ * (b - a), unit_ * (c - a));
        if (!(norm(normal) > 0) || !is_on(triangles_[t], p)) continue;
        const Vec3 unit = normal / norm(normal);
        const auto is_known = [&](Vec3 n) { return norm(n - unit) < 1e-9; };
        if (std::none_of(normals.begin(), normals.end(), is_known)) normals.push_back(unit);
      }
      continue;
    }
    const std::array<float, 4> distances = squared_distances(nodes_[next], f);
    for (std::size_t i = 0; i < 4; ++i) {
      if (distances[i] <= slack * slack) stack.push(nodes_[next].child[i]);
    }
  }
  return normals;
}

Winding TriangleTree::winding(Vec3 p) const {
  Winding out;
  const Vec3 q = to_unit(p);
  const std::array<float, 3> f = to_floats(q);
  const double slack = 2e-7 * (size_of(q) + 2);  // of rounding to floats
  // A closed surface is left as often on one side as it is entered on the other: the side with less of it is quicker.
  const int direction = q.x < 0 ? -1 : 1;
  Stack<std::uint32_t> stack;
  stack.push(0);
  while (!stack.empty()) {
    const std::uint32_t next = stack.pop();
    if ((next & Node::leaf) != 0) {
      for (const std::uint32_t t : triangles_of(next)) meet(triangles_[t], p, direction, out);
      continue;
    }
    const Node& node = nodes_[next];
    const std::array<float, 4> ahead = ray_distances(node, f, direction);
    for (std::size_t i = 0; i < 4; ++i) {
      if (ahead[i] <= slack) stack.push(node.child[i]);
    }
  }
  return out;
}

}  // namespace meso::implicit
