// SPDX-License-Identifier: Apache-2.0
#include "sliver_collapse.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

namespace meso::implicit {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t dead = none;  // first corner of a triangle that is gone

Vec3 normal(const std::array<Vec3, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); }

// Smallest altitude over longest side, up to a factor.
double quality(const std::array<Vec3, 3>& t) {
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, dot(t[i] - t[(i + 1) % 3], t[i] - t[(i + 1) % 3]));
  return longest > 0 ? norm(normal(t)) / longest : 0;
}

class Collapse {
 public:
  Collapse(TriangleMesh& mesh, const Box3& box, double spacing)
      : points_(mesh.points), triangles_(mesh.triangles), box_(box), spacing_(spacing) {}

  bool run(const RunOptions& run);
  void compact();

 private:
  struct Edge {
    double squared_length;
    std::uint32_t a, b;
    bool operator<(const Edge& e) const {
      return std::tie(squared_length, a, b) < std::tie(e.squared_length, e.a, e.b);
    }
  };

  void link_corners();
  [[nodiscard]] std::vector<Edge> short_edges() const;
  [[nodiscard]] bool collapse(std::uint32_t from, std::uint32_t onto);
  [[nodiscard]] bool keeps_manifold(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] bool keeps_shape(std::uint32_t from, std::uint32_t onto) const;
  [[nodiscard]] unsigned planes(std::uint32_t point) const;
  void neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const;
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const auto& t = triangles_[triangle];
    return {points_[t[0]], points_[t[1]], points_[t[2]]};
  }
  template <class Visit>
  void visit_triangles(std::uint32_t point, Visit visit) const {
    for (std::uint32_t c = head_[point]; c != none; c = next_[c])
      if (triangles_[c / 3][0] != dead) visit(c / 3);
  }
  [[nodiscard]] bool has(std::uint32_t triangle, std::uint32_t point) const {
    const auto& t = triangles_[triangle];
    return t[0] == point || t[1] == point || t[2] == point;
  }

  std::vector<Vec3>& points_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  const Box3& box_;
  double spacing_;
  std::vector<std::uint32_t> head_, tail_, next_;  // corners of each point, as lists that join in no time
  std::vector<std::uint32_t> near_a_, near_b_, common_;
};

void Collapse::link_corners() {
  head_.assign(points_.size(), none);
  tail_.assign(points_.size(), none);
  next_.assign(3 * triangles_.size(), none);
  for (std::uint32_t c = 0; c < next_.size(); ++c) {
    const std::uint32_t p = triangles_[c / 3][c % 3];
    (head_[p] == none ? head_[p] : next_[tail_[p]]) = c;
    tail_[p] = c;
  }
}

std::vector<Collapse::Edge> Collapse::short_edges() const {
  const double most = spacing_ / 4;
  std::vector<Edge> edges;
  for (const auto& t : triangles_) {
    if (t[0] == dead) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (a > b) continue;  // the other triangle of the edge has it
      const Vec3 d = points_[a] - points_[b];
      if (dot(d, d) < most * most) edges.push_back({dot(d, d), a, b});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Bits: on which planes of the box.
unsigned Collapse::planes(std::uint32_t point) const {
  unsigned bits = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (points_[point][axis] == box_.min[axis]) bits |= 1U << 2 * axis;
    if (points_[point][axis] == box_.max[axis]) bits |= 2U << 2 * axis;
  }
  return bits;
}

void Collapse::neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const {
  out.clear();
  visit_triangles(point, [&](std::uint32_t t) {
    for (const std::uint32_t p : triangles_[t])
      if (p != point) out.push_back(p);
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

// The link condition; and four triangles must be left over.
bool Collapse::keeps_manifold(std::uint32_t a, std::uint32_t b) {
  neighbours(a, near_a_);
  neighbours(b, near_b_);
  common_.clear();
  std::set_intersection(near_a_.begin(), near_a_.end(), near_b_.begin(), near_b_.end(), std::back_inserter(common_));
  if (common_.size() != 2 || near_a_.size() + near_b_.size() < 9) return false;
  // Two triangles at the edge: both opposite corners are the common neighbours.
  unsigned at_edge = 0;
  visit_triangles(a, [&](std::uint32_t t) { at_edge += has(t, b) ? 1 : 0; });
  return at_edge == 2;
}

bool Collapse::keeps_shape(std::uint32_t from, std::uint32_t onto) const {
  constexpr double cosine = 0.5;       // of the largest turn of a triangle against the mean direction around `from`
  constexpr double trustworthy = 0.1;  // quality from which on a triangle's plane means something
  const double tolerance = spacing_ / 50;
  Vec3 mean;
  double worst = 1;
  bool good = true;
  visit_triangles(from, [&](std::uint32_t t) {
    const auto c = corners(t);
    const Vec3 n = normal(c);
    const double q = quality(c);
    mean += n;
    worst = std::min(worst, q);
    if (q > trustworthy) good = good && std::fabs(dot(n, points_[onto] - points_[from])) <= tolerance * norm(n);
  });
  visit_triangles(from, [&](std::uint32_t t) {
    if (!good || has(t, onto)) return;
    auto c = corners(t);
    for (std::size_t i = 0; i < 3; ++i)
      if (triangles_[t][i] == from) c[i] = points_[onto];
    const Vec3 n = normal(c);
    good = quality(c) > worst && dot(n, mean) > cosine * norm(n) * norm(mean);
  });
  return good;
}

bool Collapse::collapse(std::uint32_t from, std::uint32_t onto) {
  if ((planes(from) & ~planes(onto)) != 0 || !keeps_shape(from, onto)) return false;
  visit_triangles(from, [&](std::uint32_t t) {
    if (has(t, onto))
      triangles_[t][0] = dead;
    else
      std::replace(triangles_[t].begin(), triangles_[t].end(), from, onto);
  });
  next_[tail_[onto]] = head_[from];
  tail_[onto] = tail_[from];
  head_[from] = none;
  return true;
}

bool Collapse::run(const RunOptions& run) {
  link_corners();
  for (std::size_t collapsed = 1; collapsed > 0;) {
    collapsed = 0;
    std::size_t looked = 0;
    for (const Edge& e : short_edges()) {
      if (looked++ % 4096 == 0 && run.should_stop()) return false;
      if (head_[e.a] == none || head_[e.b] == none || !keeps_manifold(e.a, e.b)) continue;
      if (collapse(e.a, e.b) || collapse(e.b, e.a)) ++collapsed;
    }
  }
  return true;
}

void Collapse::compact() {
  std::erase_if(triangles_, [](const auto& t) { return t[0] == dead; });
  std::vector<std::uint32_t>& number = tail_;
  std::uint32_t kept = 0;
  for (std::uint32_t p = 0; p < points_.size(); ++p) {
    if (head_[p] == none) continue;
    points_[kept] = points_[p];
    number[p] = kept++;
  }
  points_.resize(kept);
  for (auto& t : triangles_)
    for (std::uint32_t& p : t) p = number[p];
}

}  // namespace

bool collapse_slivers(TriangleMesh& mesh, const Box3& box, double spacing, const RunOptions& run) {
  Collapse collapse(mesh, box, spacing);
  if (!collapse.run(run)) return false;
  collapse.compact();
  return true;
}

}  // namespace meso::implicit
