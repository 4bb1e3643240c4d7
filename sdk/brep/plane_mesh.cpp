// SPDX-License-Identifier: Apache-2.0
#include "plane_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

namespace meso::brep {
namespace {

__extension__ using Wide = __int128;
using Index = std::uint32_t;
constexpr Index nothing = ~Index{0};

struct GridPoint {
  std::int64_t x = 0, y = 0;
  friend bool operator==(const GridPoint&, const GridPoint&) = default;
};
constexpr std::int64_t half_width = std::int64_t{1} << 28;

/// > 0: counter-clockwise.
std::int64_t turn(GridPoint a, GridPoint b, GridPoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// True if d lies within the circle through a, b, c (counter-clockwise).
bool in_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const auto square = [&](GridPoint p) { return Wide{(p.x - d.x) * (p.x - d.x) + (p.y - d.y) * (p.y - d.y)}; };
  return square(a) * turn(d, b, c) + square(b) * turn(d, c, a) + square(c) * turn(d, a, b) > 0;
}

/// Rounded so that the region fills the grid. Empty where two points become one.
std::vector<GridPoint> on_grid(std::span<const PlanePoint> points) {
  PlanePoint low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (const PlanePoint& p : points)
    for (std::size_t i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  const double scale = (half_width - 2) / (std::max(high[0] - low[0], high[1] - low[1]) / 2);
  std::vector<GridPoint> out;
  const auto rounded = [&](const PlanePoint& p, std::size_t i) {
    return static_cast<std::int64_t>(std::llround((p[i] - (low[i] + high[i]) / 2) * scale));
  };
  if (!std::isfinite(scale)) return out;
  for (const PlanePoint& p : points) out.push_back({rounded(p, 0), rounded(p, 1)});
  return out;
}

/// Position along a Hilbert curve through 2^16 by 2^16 squares: neighbours in it are neighbours in the plane.
std::uint64_t along_curve(GridPoint p) {
  auto x = static_cast<std::uint32_t>((p.x + half_width) >> 13),
       y = static_cast<std::uint32_t>((p.y + half_width) >> 13);
  std::uint64_t d = 0;
  for (std::uint32_t s = 1U << 15; s > 0; s /= 2) {
    const bool right = (x & s) != 0, upper = (y & s) != 0;
    d = 4 * d + (right ? (upper ? 2U : 3U) : (upper ? 1U : 0U));
    if (upper) continue;
    if (right) {
      x = ~x;
      y = ~y;
    }
    std::swap(x, y);
  }
  return d;
}

class Triangles {
 public:
  /// Four corners around the grid stand behind the points: they are never reached by a loop.
  explicit Triangles(std::vector<GridPoint> points)
      : points_(std::move(points)), incident_(points_.size() + 4, nothing) {
    const auto corner = static_cast<Index>(points_.size());
    points_.insert(
        points_.end(),
        {{-half_width, -half_width}, {half_width, -half_width}, {half_width, half_width}, {-half_width, half_width}});
    triangles_ = {{{corner, corner + 1, corner + 2}, {nothing, 1, nothing}},
                  {{corner, corner + 2, corner + 3}, {nothing, nothing, 0}}};
    for (Index t = 0; t < 2; ++t) note(t);
  }

  /// False if another point is at the same place.
  bool insert(Index p) {
    const auto [t, side] = find(p);
    if (t == nothing) return false;
    if (side == nothing)
      split_triangle(t, p);
    else
      split_side(t, side, p);
    restore_circles(p);
    return true;
  }

  /// Makes a-b a side. False if a point or another such side is in the way.
  bool fix(Index a, Index b) {
    auto crossed = sides_between(a, b);
    if (!crossed) return false;
    std::vector<Side> fresh;
    while (!crossed->empty()) {
      const Side side = crossed->front();
      crossed->pop_front();
      const auto [t, k] = where(side);
      const Index u = triangles_[t].next[k], p = triangles_[t].corner[k], q = opposite(u, t);
      if (turn(at(p), at(side.a), at(q)) <= 0 || turn(at(q), at(side.b), at(p)) <= 0) {
        crossed->push_back(side);  // not convex yet: its neighbours will change
        continue;
      }
      flip(t, k);
      const bool touches = p == a || p == b || q == a || q == b;
      const bool crosses = !touches && (turn(at(a), at(b), at(p)) > 0) != (turn(at(a), at(b), at(q)) > 0);
      if (crosses)
        crossed->push_back({p, q});
      else
        fresh.push_back({p, q});
    }
    const auto [t, k] = where({a, b});
    Triangle& triangle = triangles_[t];
    Triangle& other = triangles_[triangle.next[k]];
    triangle.fixed[k] = true;
    triangle.borders[k] = !triangle.borders[k];
    const std::size_t back = index_of(other.next, t);
    other.fixed[back] = true;
    other.borders[back] = triangle.borders[k];
    restore_circles(fresh);
    return true;
  }

  /// The triangles that are separated from the outside by an odd number of borders.
  [[nodiscard]] std::vector<std::array<Index, 3>> within() const {
    enum : char { unknown, outside, inside };
    std::vector<char> place(triangles_.size(), unknown);
    const Index start = incident_[points_.size() - 4];
    std::vector<Index> pending{start};
    place[start] = outside;
    std::vector<std::array<Index, 3>> out;
    while (!pending.empty()) {
      const Index t = pending.back();
      pending.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const Index u = triangles_[t].next[k];
        if (u == nothing || place[u] != unknown) continue;
        place[u] = (place[t] == inside) != triangles_[t].borders[k] ? inside : outside;
        pending.push_back(u);
      }
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (place[t] == inside) out.push_back(triangles_[t].corner);
    return out;
  }

 private:
  struct Triangle {
    std::array<Index, 3> corner{};                         ///< counter-clockwise
    std::array<Index, 3> next{nothing, nothing, nothing};  ///< across the side opposite to corner k
    std::array<bool, 3> fixed{}, borders{};                ///< that side is one of a loop; of an odd number of loops
  };
  struct Side {
    Index a = 0, b = 0;
  };
  struct Place {
    Index triangle = nothing;
    std::size_t side = nothing;
  };

  [[nodiscard]] bool is_frame(Index p) const { return p + 4 >= points_.size(); }
  [[nodiscard]] GridPoint at(Index p) const { return points_[p]; }
  static std::size_t index_of(const std::array<Index, 3>& values, Index value) {
    return values[0] == value ? 0 : values[1] == value ? 1 : 2;
  }
  static std::size_t after(std::size_t k) { return k == 2 ? 0 : k + 1; }
  static std::size_t before(std::size_t k) { return k == 0 ? 2 : k - 1; }
  /// The corner of `t` across the side that it shares with `from`.
  [[nodiscard]] Index opposite(Index t, Index from) const {
    return triangles_[t].corner[index_of(triangles_[t].next, from)];
  }
  void note(Index t) {
    for (const Index corner : triangles_[t].corner) incident_[corner] = t;
    last_ = t;
  }
  void link(Index t, Index from, Index to) {
    if (t != nothing) triangles_[t].next[index_of(triangles_[t].next, from)] = to;
  }

  /// Walks towards p over sides that it lies beyond.
  [[nodiscard]] Place find(Index p) const {
    Index t = last_;
    for (;;) {
      const Triangle& triangle = triangles_[t];
      std::size_t on = nothing, beyond = nothing;
      for (std::size_t k = 0; k < 3 && beyond == nothing; ++k) {
        const std::int64_t side = turn(at(triangle.corner[after(k)]), at(triangle.corner[before(k)]), at(p));
        if (side < 0) beyond = k;
        if (side == 0) on = on == nothing ? k : 3;  // on two sides: it is their corner
      }
      if (beyond == nothing) return on == 3 ? Place{} : Place{t, on};
      t = triangle.next[beyond];
    }
  }

  void split_triangle(Index t, Index p) {
    const Triangle old = triangles_[t];
    const auto n = static_cast<Index>(triangles_.size());
    const std::array<Index, 3> ids{t, n, n + 1};
    triangles_.resize(triangles_.size() + 2);
    for (std::size_t k = 0; k < 3; ++k) {  // piece k keeps the side opposite to corner k
      Triangle& piece = triangles_[ids[k]];
      piece.corner = {p, old.corner[after(k)], old.corner[before(k)]};
      piece.next = {old.next[k], ids[after(k)], ids[before(k)]};
      piece.fixed = piece.borders = {};
      link(old.next[k], t, ids[k]);
    }
    for (const Index id : ids) note(id);
  }

  void split_side(Index t, std::size_t k, Index p) {
    split_triangle(t, p);
    flip(k == 0 ? t : static_cast<Index>(triangles_.size() - 3 + k), 0);  // the piece without area
  }

  /// Turns the side opposite to corner k about: t = (p, a, b) and u = (q, b, a) become (p, a, q) and (q, b, p).
  void flip(Index t, std::size_t k) {
    const Triangle one = triangles_[t];
    const Index u = one.next[k];
    const Triangle two = triangles_[u];
    const std::size_t l = index_of(two.next, t);
    const Index p = one.corner[k], a = one.corner[after(k)], b = one.corner[before(k)], q = two.corner[l];
    Triangle &first = triangles_[t], &second = triangles_[u];
    first.corner = {p, a, q};
    first.next = {two.next[after(l)], u, one.next[before(k)]};
    first.fixed = {two.fixed[after(l)], false, one.fixed[before(k)]};
    first.borders = {two.borders[after(l)], false, one.borders[before(k)]};
    second.corner = {q, b, p};
    second.next = {one.next[after(k)], t, two.next[before(l)]};
    second.fixed = {one.fixed[after(k)], false, two.fixed[before(l)]};
    second.borders = {one.borders[after(k)], false, two.borders[before(l)]};
    link(first.next[0], u, t);
    link(second.next[0], t, u);
    note(t);
    note(u);
  }

  [[nodiscard]] bool is_delaunay(Index t, std::size_t k) const {
    const Triangle& triangle = triangles_[t];
    const Index u = triangle.next[k];
    if (u == nothing || triangle.fixed[k]) return true;
    return !in_circle(at(triangle.corner[0]), at(triangle.corner[1]), at(triangle.corner[2]), at(opposite(u, t)));
  }

  void restore_circles(Index p) {
    std::vector<Index> pending;
    Index t = incident_[p];
    const Index first = t;
    do {  // all around p
      pending.push_back(t);
      t = triangles_[t].next[after(index_of(triangles_[t].corner, p))];
    } while (t != first);
    while (!pending.empty()) {
      t = pending.back();
      pending.pop_back();
      const std::size_t k = index_of(triangles_[t].corner, p);
      if (is_delaunay(t, k)) continue;
      const Index u = triangles_[t].next[k];
      flip(t, k);
      pending.push_back(t);
      pending.push_back(u);
    }
  }

  void restore_circles(const std::vector<Side>& sides) {
    std::deque<Side> pending(sides.begin(), sides.end());
    while (!pending.empty()) {
      const Side side = pending.front();
      pending.pop_front();
      const auto [t, k] = where(side);
      if (t == nothing || is_delaunay(t, k)) continue;
      const Index u = triangles_[t].next[k], p = triangles_[t].corner[k], q = opposite(u, t);
      flip(t, k);
      for (const Index end : {side.a, side.b}) pending.insert(pending.end(), {{p, end}, {q, end}});
    }
  }

  /// The triangle on the left of a side, and the corner opposite.
  [[nodiscard]] Place where(Side side) const {
    if (is_frame(side.a)) {  // no way all around it
      const Place back = is_frame(side.b) ? Place{} : where({side.b, side.a});
      if (back.triangle == nothing) return {};
      const Index u = triangles_[back.triangle].next[back.side];
      return {u, index_of(triangles_[u].next, back.triangle)};
    }
    Index t = incident_[side.a];
    const Index first = t;
    do {
      const std::size_t k = index_of(triangles_[t].corner, side.a);
      if (triangles_[t].corner[after(k)] == side.b) return {t, before(k)};
      t = triangles_[t].next[after(k)];
    } while (t != first);
    return {};
  }

  /// The sides that the segment from a to b crosses, in order; none if it is a side.
  [[nodiscard]] std::optional<std::deque<Side>> sides_between(Index a, Index b) const {
    std::deque<Side> out;
    if (where({a, b}).triangle != nothing) return out;
    Index t = incident_[a];
    const Index first = t;
    std::size_t k = 0;
    for (;;) {  // the triangle at a that b lies behind
      k = index_of(triangles_[t].corner, a);
      const Index right = triangles_[t].corner[after(k)], left = triangles_[t].corner[before(k)];
      if (turn(at(a), at(b), at(right)) < 0 && turn(at(a), at(b), at(left)) > 0) break;
      t = triangles_[t].next[after(k)];
      if (t == first) return {};
    }
    for (;;) {
      const Triangle& triangle = triangles_[t];
      if (triangle.fixed[k]) return {};
      out.push_back({triangle.corner[after(k)], triangle.corner[before(k)]});
      const Index u = triangle.next[k], q = opposite(u, t);
      if (q == b) return out;
      const std::int64_t side = turn(at(a), at(b), at(q));
      if (side == 0) return {};
      const Index leave = triangle.corner[side > 0 ? before(k) : after(k)];
      t = u;
      k = index_of(triangles_[u].corner, leave);
    }
  }

  std::vector<GridPoint> points_;
  std::vector<Index> incident_;  ///< a triangle at each point
  std::vector<Triangle> triangles_;
  Index last_ = 0;
};

}  // namespace

std::optional<std::vector<std::array<std::uint32_t, 3>>> triangulate_between(
    std::span<const PlanePoint> points, std::span<const std::vector<std::uint32_t>> loops) {
  std::vector<GridPoint> grid = on_grid(points);
  if (grid.empty()) return {};
  std::vector<std::uint64_t> place(grid.size());
  std::ranges::transform(grid, place.begin(), along_curve);
  std::vector<Index> order(grid.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Index p) { return std::pair(place[p], p); });
  Triangles triangles(std::move(grid));
  for (const Index p : order)
    if (!triangles.insert(p)) return {};
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (!triangles.fix(loop[i], loop[(i + 1) % loop.size()])) return {};
  return triangles.within();
}

}  // namespace meso::brep
