// SPDX-License-Identifier: Apache-2.0
#include "winding_number.hpp"

#include <algorithm>
#include <numbers>

namespace meso::implicit {
namespace {

using Node = TriangleTree::Node;

template <class Visit>
void visit_leaf(std::uint32_t child, Visit visit) {
  const std::uint32_t first = child & Node::first_mask;
  const std::uint32_t last = first + ((child & ~Node::leaf) >> Node::count_shift);
  for (std::uint32_t i = first; i <= last; ++i) visit(i);
}

bool is_empty(const Node& node, std::size_t slot) { return !(node.low[0][slot] <= node.high[0][slot]); }

void add_outer(Mat3& sum, Vec3 a, Vec3 b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) sum(i, j) += a[i] * b[j];
  }
}

}  // namespace

WindingNumber::Moments WindingNumber::moments_of(const Triangle& t) {
  const Vec3 middle = (t[0] + t[1] + t[2]) / 3, normal = 0.5 * cross(t[1] - t[0], t[2] - t[0]);
  const double radius = std::max({norm(t[0] - middle), norm(t[1] - middle), norm(t[2] - middle)});
  return {middle, radius, norm(normal), normal};
}

double winding_of_triangle(const Triangle& t, Vec3 p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double volume = dot(a, cross(b, c));
  const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return std::atan2(volume, below) / (2 * std::numbers::pi);
}

WindingNumber::WindingNumber(const TriangleTree& tree) : moments_(tree.nodes().size()) {
  for (std::size_t n = moments_.size(); n-- > 0;) gather(tree, n);  // children have larger numbers
}

void WindingNumber::gather(const TriangleTree& tree, std::size_t number) {
  std::vector<Moments> parts;
  const Node& node = tree.nodes()[number];
  for (std::size_t i = 0; i < 4; ++i) {
    if (is_empty(node, i)) continue;
    if ((node.child[i] & Node::leaf) == 0)
      parts.push_back(moments_[node.child[i]]);
    else
      visit_leaf(node.child[i], [&](std::uint32_t t) { parts.push_back(moments_of(tree.triangles()[t])); });
  }
  Moments& sum = moments_[number];
  Vec3 plain, weighted;
  for (const Moments& m : parts) {
    plain += m.middle;
    weighted += m.area * m.middle;
    sum.area += m.area;
    sum.normal += m.normal;
  }
  sum.middle = sum.area > 0 ? weighted / sum.area : plain / double(parts.size());
  for (const Moments& m : parts) {
    const Vec3 offset = m.middle - sum.middle;
    sum.radius = std::max(sum.radius, norm(offset) + m.radius);
    for (std::size_t i = 0; i < 9; ++i) sum.spread.m[i] += m.spread.m[i];
    add_outer(sum.spread, offset, m.normal);
  }
}

double WindingNumber::at(const TriangleTree& tree, Vec3 p) const {
  constexpr double beta = 2;  // farther than this many radii a part counts as one dipole
  double far = 0, near = 0;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t next = stack.back();
    stack.pop_back();
    if ((next & Node::leaf) != 0) {
      visit_leaf(next, [&](std::uint32_t t) { near += winding_of_triangle(tree.triangles()[t], p); });
      continue;
    }
    const Moments& m = moments_[next];
    const Vec3 r = m.middle - p;
    const double r2 = dot(r, r);
    if (r2 > beta * beta * m.radius * m.radius) {
      const double trace = m.spread(0, 0) + m.spread(1, 1) + m.spread(2, 2);
      far += (dot(m.normal, r) + trace - 3 * dot(r, m.spread * r) / r2) / (r2 * std::sqrt(r2));
      continue;
    }
    const Node& node = tree.nodes()[next];
    for (std::size_t i = 0; i < 4; ++i) {
      if (!is_empty(node, i)) stack.push_back(node.child[i]);
    }
  }
  return near + far / (4 * std::numbers::pi);
}

}  // namespace meso::implicit
