// SPDX-License-Identifier: Apache-2.0
#include "sliver_collapse.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "mesh_links.hpp"

namespace meso::implicit {
namespace {

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
      : points_(mesh.points), triangles_(mesh.triangles), links_(mesh), box_(box), spacing_(spacing) {}

  bool run(const RunOptions& run);
  void compact() { links_.compact(); }

 private:
  struct Edge {
    double squared_length;
    std::uint32_t a, b;
    bool operator<(const Edge& e) const {
      return std::tie(squared_length, a, b) < std::tie(e.squared_length, e.a, e.b);
    }
  };

  [[nodiscard]] std::vector<Edge> short_edges() const;
  [[nodiscard]] bool collapse(std::uint32_t from, std::uint32_t onto);
  [[nodiscard]] bool keeps_shape(std::uint32_t from, std::uint32_t onto) const;
  [[nodiscard]] unsigned planes(std::uint32_t point) const;
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const auto& t = triangles_[triangle];
    return {points_[t[0]], points_[t[1]], points_[t[2]]};
  }

  std::vector<Vec3>& points_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  MeshLinks links_;
  const Box3& box_;
  double spacing_;
};

std::vector<Collapse::Edge> Collapse::short_edges() const {
  const double most = spacing_ / 4;
  std::vector<Edge> edges;
  for (std::uint32_t n = 0; n < triangles_.size(); ++n) {
    if (!links_.has_triangle(n)) continue;
    const std::array<std::uint32_t, 3>& t = triangles_[n];
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

bool Collapse::keeps_shape(std::uint32_t from, std::uint32_t onto) const {
  constexpr double cosine = 0.5;       // of the largest turn of a triangle against the mean direction around `from`
  constexpr double trustworthy = 0.1;  // quality from which on a triangle's plane means something
  const double tolerance = spacing_ / 50;
  Vec3 mean;
  double worst = 1;
  bool good = true;
  links_.visit_triangles(from, [&](std::uint32_t t) {
    const auto c = corners(t);
    const Vec3 n = normal(c);
    const double q = quality(c);
    mean += n;
    worst = std::min(worst, q);
    if (q > trustworthy) good = good && std::fabs(dot(n, points_[onto] - points_[from])) <= tolerance * norm(n);
  });
  links_.visit_triangles(from, [&](std::uint32_t t) {
    if (!good || links_.is_corner(t, onto)) return;
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
  links_.collapse(from, onto);
  return true;
}

bool Collapse::run(const RunOptions& run) {
  for (std::size_t collapsed = 1; collapsed > 0;) {
    collapsed = 0;
    std::size_t looked = 0;
    for (const Edge& e : short_edges()) {
      if (looked++ % 4096 == 0 && run.should_stop()) return false;
      if (!links_.has_point(e.a) || !links_.has_point(e.b) || !links_.stays_manifold(e.a, e.b)) continue;
      if (collapse(e.a, e.b) || collapse(e.b, e.a)) ++collapsed;
    }
  }
  return true;
}

}  // namespace

bool collapse_slivers(TriangleMesh& mesh, const Box3& box, double spacing, const RunOptions& run) {
  Collapse collapse(mesh, box, spacing);
  if (!collapse.run(run)) return false;
  collapse.compact();
  return true;
}

}  // namespace meso::implicit
