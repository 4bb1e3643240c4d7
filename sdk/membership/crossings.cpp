// SPDX-License-Identifier: Apache-2.0
#include "meso/membership/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace meso::membership {
namespace {

/// Into a frame whose z, the rays' direction, is oblique to everything in documents.
Vec3 turned(Vec3 p) {
  static const Mat3 oblique = rotation(Vec3{1, 2, 3} / std::sqrt(14.0), 0.7654321);
  return oblique * p;
}

/// On the left of the line from a to b, seen along z. Turning the line round turns the answer round, exactly.
bool is_left(Vec3 a, Vec3 b, Vec3 p) {
  if (b.x < a.x || (b.x == a.x && b.y < a.y)) return !is_left(b, a, p);
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
}

/// How the ray upwards from p crosses the triangle: 1 out of the body, -1 into it, 0 not at all.
int crossing(const Triangle& t, Vec3 p) {
  const bool left = is_left(t[0], t[1], p);
  if (is_left(t[1], t[2], p) != left || is_left(t[2], t[0], p) != left) return 0;
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double z = t[0].z - (n.x * (p.x - t[0].x) + n.y * (p.y - t[0].y)) / n.z;
  return z > p.z ? (left ? 1 : -1) : 0;
}

Triangle turned(const Triangle& t) { return {turned(t[0]), turned(t[1]), turned(t[2])}; }

/// Squares over the x and y of a box, about as many as there are things to sort.
class Columns {
 public:
  Columns(const Box3& box, std::size_t things)
      : box_(box), along_(std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(things))))) {}

  [[nodiscard]] std::size_t count() const { return along_ * along_; }
  [[nodiscard]] std::size_t of(Vec3 p) const { return at(p, 0) * along_ + at(p, 1); }
  /// Every column under the triangle's box.
  template <class Visit>
  void under(const Triangle& t, Visit visit) const {
    Box3 box;
    for (const Vec3 p : t) box.extend(p);
    if (!box.intersects(box_)) return;
    for (std::size_t i = at(box.min, 0), i_last = at(box.max, 0), j_last = at(box.max, 1); i <= i_last; ++i)
      for (std::size_t j = at(box.min, 1); j <= j_last; ++j) visit(i * along_ + j);
  }

 private:
  [[nodiscard]] std::size_t at(Vec3 p, std::size_t axis) const {
    const double size = box_.max[axis] - box_.min[axis];
    const double place = size > 0 ? (p[axis] - box_.min[axis]) / size * static_cast<double>(along_) : 0;
    return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(along_ - 1)));
  }
  Box3 box_;
  std::size_t along_;
};

struct Sorted {
  std::vector<std::size_t> first;    ///< of each column, and one past the last
  std::vector<std::uint32_t> order;  ///< things by column
};

/// Counting sort. `visit(i, add)` calls add(column) for each column of thing i.
template <class Visit>
Sorted sort_by_column(std::size_t columns, std::size_t things, Visit visit) {
  Sorted out;
  out.first.assign(columns + 1, 0);
  for (std::size_t i = 0; i < things; ++i) visit(i, [&](std::size_t c) { ++out.first[c + 1]; });
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.order.resize(out.first.back());
  std::vector<std::size_t> next(out.first.begin(), out.first.end() - 1);
  for (std::size_t i = 0; i < things; ++i)
    visit(i, [&](std::size_t c) { out.order[next[c]++] = static_cast<std::uint32_t>(i); });
  return out;
}

}  // namespace

std::vector<bool> inside_of(const TriangleStream& triangles, std::span<const Vec3> points, const RunOptions& run) {
  if (points.empty()) return {};
  std::vector<Vec3> oblique(points.begin(), points.end());
  Box3 box;
  for (Vec3& p : oblique) box.extend(p = turned(p));
  box.max.z = HUGE_VAL;  // rays go upwards
  const Columns columns(box, points.size());
  const Sorted sorted =
      sort_by_column(columns.count(), oblique.size(), [&](std::size_t i, auto add) { add(columns.of(oblique[i])); });
  std::vector<Vec3> in_order;
  for (const std::uint32_t i : sorted.order) in_order.push_back(oblique[i]);
  std::vector<int> sums(points.size(), 0);
  std::size_t blocks = 0;
  bool stopped = false;
  triangles([&](std::span<const Triangle> block) {
    if (++blocks % 1024 == 0) stopped = stopped || run.should_stop();
    if (stopped) return;
    for (const Triangle& triangle : block) {
      const Triangle t = turned(triangle);
      const double top = std::max({t[0].z, t[1].z, t[2].z});
      columns.under(t, [&](std::size_t c) {
        for (std::size_t i = sorted.first[c]; i < sorted.first[c + 1]; ++i)
          if (in_order[i].z < top) sums[i] += crossing(t, in_order[i]);
      });
    }
  });
  std::vector<bool> inside(points.size());
  for (std::size_t i = 0; i < sums.size(); ++i) inside[sorted.order[i]] = sums[i] != 0;
  return inside;
}

struct TriangleSolid::Impl {
  Box3 box, oblique_box;
  std::vector<Triangle> triangles;  ///< oblique
  std::optional<Columns> columns;
  Sorted sorted;
};

TriangleSolid::TriangleSolid(const TriangleMesh& mesh) {
  auto impl = std::make_shared<Impl>();
  triangles_of(mesh)([&](std::span<const Triangle> block) {
    for (const Triangle& t : block) {
      impl->triangles.push_back(turned(t));
      for (const Vec3 p : t) impl->box.extend(p);
      for (const Vec3 p : impl->triangles.back()) impl->oblique_box.extend(p);
    }
  });
  impl->columns.emplace(impl->oblique_box, impl->triangles.size());
  impl->sorted = sort_by_column(impl->columns->count(), impl->triangles.size(),
                                [&](std::size_t i, auto add) { impl->columns->under(impl->triangles[i], add); });
  impl_ = std::move(impl);
}

bool TriangleSolid::contains(Vec3 p) const {
  if (!impl_->box.intersects({p, p})) return false;
  const Vec3 oblique = turned(p);
  const std::size_t column = impl_->columns->of(oblique);
  int sum = 0;
  for (std::size_t i = impl_->sorted.first[column]; i < impl_->sorted.first[column + 1]; ++i)
    sum += crossing(impl_->triangles[impl_->sorted.order[i]], oblique);
  return sum != 0;
}

const Box3& TriangleSolid::box() const { return impl_->box; }

}  // namespace meso::membership
