// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_mitre_mesh.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
using Indices = std::vector<std::uint32_t>;

/// One end of a strut: points of its border, and those of them that go around it without turning back.
class MitreRow {
 public:
  MitreRow(const MitredStrut& strut, const std::vector<Vec3>& border, bool is_last, Triangulation& mesh)
      : strut_(strut), is_last_(is_last), first_(static_cast<std::uint32_t>(mesh.points.size())), mesh_(mesh) {
    for (const Vec3& p : border) {
      const Vec3 v = p - strut.origin;
      const double turn = std::atan2(dot(v, strut.y), dot(v, strut.x));
      const double height = dot(v, strut.axis);
      points_.push_back({p, points_.empty() ? 0 : turn < 0 ? turn + 2 * pi : turn});
      heights_.push_back(is_last ? -height : height);
      mesh.points.push_back({.point = p});
    }
    points_.push_back({border.front(), 2 * pi});
    heights_.push_back(heights_.front());
  }

  /// Triangles of what lies between a border and where it turns back; the other points remain.
  void unfold() {
    const auto count = static_cast<std::uint32_t>(points_.size());
    row_ = {0};
    for (std::uint32_t i = 1; i < count; ++i) {
      if (turn(i) >= turn(row_.back())) {
        row_.push_back(i);
        continue;
      }
      const std::uint32_t from = row_.back();
      std::uint32_t to = i;
      while (to + 1 < count && turn(to + 1) < turn(to)) ++to;
      i = heights_[to] > heights_[from] ? end_before(from, to) : end_behind(from, to);
    }
  }

  /// Across from each point of the row, farther along the strut.
  [[nodiscard]] std::vector<RingPoint> ring(double along) const {
    const double r = strut_.radius + strut_.growth * along;
    std::vector<RingPoint> out;
    for (const std::uint32_t i : row_) {
      const Vec3 e = std::cos(turn(i)) * strut_.x + std::sin(turn(i)) * strut_.y;
      out.push_back({strut_.origin + r * e + along * strut_.axis, turn(i)});
    }
    out.back().point = out.front().point;
    return out;
  }

  /// Between the row and its ring, whose points are in the mesh from `ring` on.
  void join(std::uint32_t ring) {
    const auto count = static_cast<std::uint32_t>(row_.size()) - 1;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t next = (i + 1) % count;
      add(number(row_[i]), number(row_[i + 1]), ring + next);
      add(number(row_[i]), ring + next, ring + i);
    }
  }

 private:
  [[nodiscard]] double turn(std::uint32_t i) const { return points_[i].turn; }
  [[nodiscard]] std::uint32_t number(std::uint32_t i) const { return i + 1 == points_.size() ? first_ : first_ + i; }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == b || b == c || c == a) return;
    if (is_last_) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  /// The border comes to a tip at `from` and goes back above itself to `to`.
  std::uint32_t end_before(std::uint32_t from, std::uint32_t to) {
    Indices low{from}, high;
    while (row_.size() > 1 && turn(row_.back()) >= turn(to)) {
      row_.pop_back();
      low.insert(low.begin(), row_.back());
    }
    for (std::uint32_t i = to; i > from; --i) high.push_back(i);
    high.push_back(from);
    fill(low, high);
    row_.push_back(to);
    return to;
  }

  /// It goes back below itself to a tip at `to` and on from there.
  std::uint32_t end_behind(std::uint32_t from, std::uint32_t to) {
    Indices low{to}, high;
    std::uint32_t i = to;
    while (i + 1 < points_.size() && turn(i) <= turn(from)) low.push_back(++i);
    for (std::uint32_t k = to; k > from; --k) high.push_back(k);
    high.push_back(from);
    fill(low, high);
    row_.push_back(i);
    return i;
  }

  /// Between two chains that rise and have an end in common.
  void fill(const Indices& low, const Indices& high) {
    for (std::size_t i = 0, k = 0; i + 1 < low.size() || k + 1 < high.size();) {
      const bool is_low = k + 1 == high.size() ||
                          (i + 1 < low.size() && turn(low[i]) + turn(low[i + 1]) <= turn(high[k]) + turn(high[k + 1]));
      if (is_low) {
        add(number(low[i]), number(low[i + 1]), number(high[k]));
        ++i;
      } else {
        add(number(low[i]), number(high[k + 1]), number(high[k]));
        ++k;
      }
    }
  }

  const MitredStrut& strut_;
  bool is_last_;
  std::uint32_t first_;
  Triangulation& mesh_;
  std::vector<RingPoint> points_;  ///< the last is the first
  std::vector<double> heights_;    ///< from the node
  Indices row_;
};

}  // namespace

// Lines of the strut are straight, so triangles between points across from each other are as near to it as the border's
// sides are.
Triangulation mitred_mesh(const MitredStrut& strut, const std::array<std::vector<Vec3>, 2>& borders) {
  Triangulation mesh;
  MitreRow first(strut, borders[0], false, mesh), last(strut, borders[1], true, mesh);
  first.unfold();
  last.unfold();
  const double free = strut.end - strut.begin;
  const std::vector<RingPoint> lower = first.ring(strut.begin + 0.25 * free),
                               upper = last.ring(strut.begin + 0.75 * free);
  const auto ring = static_cast<std::uint32_t>(mesh.points.size());
  const Triangulation between = strut_mesh(lower, upper);
  mesh.points.insert(mesh.points.end(), between.points.begin(), between.points.end());
  for (const auto& t : between.triangles) mesh.triangles.push_back({t[0] + ring, t[1] + ring, t[2] + ring});
  first.join(ring);
  last.join(ring + static_cast<std::uint32_t>(lower.size()) - 1);
  return mesh;
}

}  // namespace meso::brep
