// SPDX-License-Identifier: Apache-2.0
#include "simplify_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "mesh_links.hpp"
#include "surface_feet.hpp"

namespace meso::implicit {
namespace {

/// The weighted sum of squared distances to planes, seen from a point of the mesh: p' a p + 2 b p + c.
struct Quadric {
  std::array<double, 6> a{};  ///< xx xy xz yy yz zz
  Vec3 b;
  double c = 0, weight = 0;

  void add_plane(Vec3 normal, double distance, double w) {
    const std::array<double, 6> n{normal.x * normal.x, normal.x * normal.y, normal.x * normal.z,
                                  normal.y * normal.y, normal.y * normal.z, normal.z * normal.z};
    for (std::size_t i = 0; i < 6; ++i) a[i] += w * n[i];
    b += w * distance * normal;
    c += w * distance * distance;
    weight += w;
  }
  Quadric& operator+=(const Quadric& q) {
    for (std::size_t i = 0; i < 6; ++i) a[i] += q.a[i];
    b += q.b;
    c += q.c;
    weight += q.weight;
    return *this;
  }
  [[nodiscard]] Vec3 times(Vec3 p) const {
    return {a[0] * p.x + a[1] * p.y + a[2] * p.z, a[1] * p.x + a[3] * p.y + a[4] * p.z,
            a[2] * p.x + a[4] * p.y + a[5] * p.z};
  }
  /// The mean.
  [[nodiscard]] double at(Vec3 p) const {
    return weight > 0 ? std::max(0.0, dot(p, times(p)) + 2 * dot(b, p) + c) / weight : 0;
  }
  /// Where it is least, by Cramer's rule; nothing where that is not well defined.
  [[nodiscard]] bool least(Vec3& p) const {
    const Mat3 m{{a[0], a[1], a[2], a[1], a[3], a[4], a[2], a[4], a[5]}};
    const double det = determinant(m);
    if (!(det > 1e-4 * weight * weight * weight)) return false;
    const Vec3 x = m.column(0), y = m.column(1), z = m.column(2);
    p = Vec3{-dot(b, cross(y, z)), -dot(x, cross(b, z)), -dot(x, cross(y, b))} / det;
    return true;
  }
};

/// Collapses by what they cost, at most 1, in a thousand classes; of one class, the first that came. Each next one
/// is found without a search: a heap of tens of millions waits for memory at each of its levels.
class CollapseQueue {
 public:
  struct Collapse {
    std::uint32_t a, b, version;
  };

  /// What is cheaper than the class that is under way joins that.
  void push(double cost, const Collapse& collapse) {
    const auto costs = static_cast<std::size_t>(cost * static_cast<double>(classes_.size()));
    classes_[std::clamp(costs, class_, classes_.size() - 1)].push_back(collapse);
  }
  [[nodiscard]] std::optional<Collapse> pop() {
    for (; class_ < classes_.size(); ++class_, next_ = 0) {
      if (next_ < classes_[class_].size()) return classes_[class_][next_++];
      classes_[class_] = {};
    }
    return std::nullopt;
  }

 private:
  std::vector<std::vector<Collapse>> classes_ = std::vector<std::vector<Collapse>>(1024);
  std::size_t class_ = 0, next_ = 0;
};

class Simplify {
 public:
  Simplify(TriangleMesh& mesh, const Box3& box, double bound, std::span<const char> kept)
      : points_(mesh.points), triangles_(mesh.triangles), links_(mesh), limit_(bound * bound / 4), kept_(kept) {
    eye_ = points_.empty() ? Vec3{} : points_[0];
    for (const Vec3& p : points_) planes_.push_back(planes_of(box, p));
  }

  bool run(const RunOptions& run);

 private:
  void push(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] bool best_place(std::uint32_t a, std::uint32_t b, Vec3& place, double& cost) const;
  [[nodiscard]] bool keeps_sides(std::uint32_t moved, std::uint32_t other, Vec3 place) const;
  void collapse(std::uint32_t a, std::uint32_t b, Vec3 place);

  std::vector<Vec3>& points_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  MeshLinks links_;
  double limit_;
  std::span<const char> kept_;
  Vec3 eye_;
  std::vector<unsigned> planes_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> version_, near_;
  CollapseQueue queue_;
};

// A point on planes of the box moves onto one that is on them, too.
bool Simplify::best_place(std::uint32_t a, std::uint32_t b, Vec3& place, double& cost) const {
  Quadric sum = quadrics_[a];
  sum += quadrics_[b];
  const bool a_goes = (planes_[a] & ~planes_[b]) == 0, b_goes = (planes_[b] & ~planes_[a]) == 0;
  cost = HUGE_VAL;
  const auto consider = [&](Vec3 p) {
    const double c = sum.at(p - eye_);
    if (c < cost) cost = c, place = p;
  };
  if (a_goes) consider(points_[b]);
  if (b_goes) consider(points_[a]);
  if (planes_[a] == planes_[b]) consider((points_[a] + points_[b]) / 2);
  Vec3 least;
  if ((planes_[a] | planes_[b]) == 0 && sum.least(least)) {
    const Vec3 middle = (points_[a] + points_[b]) / 2 - eye_;
    if (norm(least - middle) <= 2 * norm(points_[a] - points_[b])) consider(least + eye_);
  }
  return cost <= limit_;
}

void Simplify::push(std::uint32_t a, std::uint32_t b) {
  Vec3 place;
  double cost = 0;
  if (a > b) std::swap(a, b);
  if (!kept_.empty() && (kept_[a] != 0 || kept_[b] != 0)) return;
  if (best_place(a, b, place, cost)) queue_.push(std::sqrt(cost / limit_), {a, b, version_[a] + version_[b]});
}

// No triangle that is left turns by more than 60 degrees, or gets very narrow.
bool Simplify::keeps_sides(std::uint32_t moved, std::uint32_t other, Vec3 place) const {
  constexpr double narrow = 0.02;  // altitude over longest side
  bool good = true;
  links_.visit_triangles(moved, [&](std::uint32_t t) {
    if (!good || links_.is_corner(t, other)) return;
    std::array<Vec3, 3> before, after;
    for (std::size_t i = 0; i < 3; ++i) {
      before[i] = points_[triangles_[t][i]];
      after[i] = triangles_[t][i] == moved ? place : before[i];
    }
    const auto measure = [](const std::array<Vec3, 3>& c, double& quality) {
      const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
      double longest = 0;
      for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, norm(c[(i + 1) % 3] - c[i]));
      quality = norm(n) / (longest * longest);
      return n;
    };
    double quality_before = 0, quality_after = 0;
    const Vec3 n0 = measure(before, quality_before), n1 = measure(after, quality_after);
    good = dot(n0, n1) > 0.5 * norm(n0) * norm(n1) && quality_after > std::min(narrow, quality_before);
  });
  return good;
}

void Simplify::collapse(std::uint32_t a, std::uint32_t b, Vec3 place) {
  points_[a] = place;
  planes_[a] |= planes_[b];
  quadrics_[a] += quadrics_[b];
  links_.collapse(b, a);
  version_[a] += version_[b] + 1;
  links_.neighbours(a, near_);
  for (const std::uint32_t n : near_) push(a, n);
}

bool Simplify::run(const RunOptions& run) {
  quadrics_.resize(points_.size());
  version_.assign(points_.size(), 0);
  for (const auto& t : triangles_) {
    const Vec3 a = points_[t[0]] - eye_, b = points_[t[1]] - eye_, c = points_[t[2]] - eye_;
    const Vec3 n = cross(b - a, c - a);
    const double twice_area = norm(n);
    if (!(twice_area > 0)) continue;
    for (const std::uint32_t p : t) quadrics_[p].add_plane(n / twice_area, -dot(n, a) / twice_area, twice_area);
  }
  for (const auto& t : triangles_)
    for (std::size_t i = 0; i < 3; ++i)
      if (t[i] < t[(i + 1) % 3]) push(t[i], t[(i + 1) % 3]);
  std::size_t looked = 0;
  while (const auto next = queue_.pop()) {
    if (++looked % 4096 == 0 && run.should_stop()) return false;
    const auto [a, b, version] = *next;
    if (!links_.has_point(a) || !links_.has_point(b) || version != version_[a] + version_[b]) continue;
    Vec3 place;
    double cost = 0;
    if (!best_place(a, b, place, cost) || !links_.stays_manifold(a, b) || !keeps_sides(a, b, place) ||
        !keeps_sides(b, a, place))
      continue;
    collapse(a, b, place);
  }
  links_.compact();
  return true;
}

}  // namespace

bool simplify_mesh(TriangleMesh& mesh, const Box3& box, double bound, const RunOptions& run,
                   std::span<const char> kept) {
  return Simplify(mesh, box, bound, kept).run(run);
}

}  // namespace meso::implicit
