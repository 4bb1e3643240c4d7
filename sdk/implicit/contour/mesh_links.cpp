// SPDX-License-Identifier: Apache-2.0
#include "mesh_links.hpp"

#include <algorithm>
#include <iterator>

namespace meso::implicit {

MeshLinks::MeshLinks(TriangleMesh& mesh)
    : points_(mesh.points),
      triangles_(mesh.triangles),
      head_(points_.size(), none),
      tail_(points_.size(), none),
      next_(3 * triangles_.size(), none) {
  for (std::uint32_t c = 0; c < next_.size(); ++c) {
    const std::uint32_t p = triangles_[c / 3][c % 3];
    (head_[p] == none ? head_[p] : next_[tail_[p]]) = c;
    tail_[p] = c;
  }
}

void MeshLinks::neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const {
  out.clear();
  visit_triangles(point, [&](std::uint32_t t) {
    for (const std::uint32_t p : triangles_[t])
      if (p != point) out.push_back(p);
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

bool MeshLinks::stays_manifold(std::uint32_t a, std::uint32_t b) {
  neighbours(a, near_a_);
  neighbours(b, near_b_);
  common_.clear();
  std::set_intersection(near_a_.begin(), near_a_.end(), near_b_.begin(), near_b_.end(), std::back_inserter(common_));
  if (common_.size() != 2 || near_a_.size() + near_b_.size() < 9) return false;
  // Two triangles at the edge: both opposite corners are the common neighbours.
  unsigned at_edge = 0;
  visit_triangles(a, [&](std::uint32_t t) { at_edge += is_corner(t, b) ? 1 : 0; });
  return at_edge == 2;
}

bool MeshLinks::unfold(std::uint32_t a, std::uint32_t b) {
  neighbours(a, near_a_);
  neighbours(b, near_b_);
  common_.clear();
  std::set_intersection(near_a_.begin(), near_a_.end(), near_b_.begin(), near_b_.end(), std::back_inserter(common_));
  if (common_.size() != 2 || near_a_.size() < 4 || near_b_.size() < 4) return false;
  const std::uint32_t c = common_[0], d = common_[1];
  std::array<std::uint32_t, 2> folded{none, none};
  unsigned at_edge = 0;
  visit_triangles(c, [&](std::uint32_t t) {
    if (!is_corner(t, d)) return;
    ++at_edge;
    if (is_corner(t, a)) folded[0] = t;
    if (is_corner(t, b)) folded[1] = t;
  });
  if (at_edge != 2 || folded[0] == none || folded[1] == none) return false;
  for (const std::uint32_t t : folded) triangles_[t][0] = none;
  for (const std::uint32_t p : {a, b, c, d}) unlink_gone(p);
  return true;
}

// Points that took in many others would be asked for all triangles that they ever had.
void MeshLinks::unlink_gone(std::uint32_t point) {
  std::uint32_t last = none;
  for (std::uint32_t c = head_[point]; c != none; c = next_[c]) {
    if (!has_triangle(c / 3)) continue;
    (last == none ? head_[point] : next_[last]) = c;
    last = c;
  }
  (last == none ? head_[point] : next_[last]) = none;
  tail_[point] = last;
}

void MeshLinks::collapse(std::uint32_t from, std::uint32_t onto) {
  common_.clear();  // the corners opposite to the edge
  visit_triangles(from, [&](std::uint32_t t) {
    if (is_corner(t, onto)) {
      for (const std::uint32_t p : triangles_[t])
        if (p != from && p != onto) common_.push_back(p);
      triangles_[t][0] = none;
    } else {
      std::replace(triangles_[t].begin(), triangles_[t].end(), from, onto);
    }
  });
  next_[tail_[onto]] = head_[from];
  tail_[onto] = tail_[from];
  head_[from] = none;
  unlink_gone(onto);
  for (const std::uint32_t p : common_) unlink_gone(p);
}

void MeshLinks::compact() {
  std::erase_if(triangles_, [](const std::array<std::uint32_t, 3>& t) { return t[0] == none; });
  std::uint32_t kept = 0;
  for (std::uint32_t p = 0; p < points_.size(); ++p) {
    if (!has_point(p)) continue;
    points_[kept] = points_[p];
    tail_[p] = kept++;  // its new number
  }
  points_.resize(kept);
  for (std::array<std::uint32_t, 3>& t : triangles_)
    for (std::uint32_t& p : t) p = tail_[p];
}

}  // namespace meso::implicit
