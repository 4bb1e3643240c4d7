// SPDX-License-Identifier: Apache-2.0
#include "cuts.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit::stuffing {
namespace {

constexpr double root_tolerance = 1e-6;                    // of the edge
constexpr double short_edge_length = 0.86602540378443865;  // of a spacing
constexpr std::size_t edges_at_a_time = 4096;
constexpr int most_falsi_steps = 12, most_steps = 40;

std::uint32_t other_end(const Points& points, std::uint32_t owner, unsigned edge) {
  return edge < long_edges ? owner + points.stride(owner, edge)
                           : points.short_end(points.index(owner), edge - long_edges);
}

/// An edge from its inside end to its outside end, and the part of it in which the surface is.
struct Bracket {
  Vec3 from, to;
  double low = 0, high = 1;        // inside at low, outside at high
  double at_low = 0, at_high = 0;  // values; NaN is outside
  double next = 0;                 // where a value is asked
  int leaves = -1;                 // the box's plane that ends the bracket: 2 axis, + 1 for the maximum
  int stayed = 0;                  // the end that was kept in the last step: -1 low, 1 high
  bool done = false;

  [[nodiscard]] Vec3 point(double t, const Box3& box) const {
    Vec3 p = from + t * (to - from);
    if (leaves >= 0 && t == high) {
      const auto axis = static_cast<std::size_t>(leaves / 2);
      p[axis] = leaves % 2 == 0 ? box.min[axis] : box.max[axis];
    }
    return p;
  }
  void finish(double t) {
    next = t;
    done = true;
  }
};

void clip(Bracket& b, const Box3& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    const bool below = b.to[a] < box.min[a];
    if (!below && !(b.to[a] > box.max[a])) continue;
    const double t = ((below ? box.min[a] : box.max[a]) - b.from[a]) / (b.to[a] - b.from[a]);
    if (t >= b.high) continue;
    b.high = t;
    b.leaves = static_cast<int>(2 * a + (below ? 0 : 1));
  }
}

/// Regula falsi that halves the value of an end that stays (Illinois), then bisection: values need not be finite.
void choose(Bracket& b, int step) {
  const double middle = 0.5 * (b.low + b.high);
  if (b.high - b.low <= root_tolerance) return b.finish(middle);
  const double t = b.low + (b.high - b.low) * (b.at_low / (b.at_low - b.at_high));
  // A root next to an end is passed by a little, so that the other end comes along.
  const double margin = 0.4 * root_tolerance;
  b.next = step < most_falsi_steps && std::isfinite(t) ? std::clamp(t, b.low + margin, b.high - margin) : middle;
}

void narrow(Bracket& b, double value) {
  b.leaves = -1;
  if (value < 0) {
    b.low = b.next;
    b.at_low = value;
    if (b.stayed == 1) b.at_high /= 2;
    b.stayed = 1;
  } else {
    b.high = b.next;
    b.at_high = value;
    if (b.stayed == -1) b.at_low /= 2;
    b.stayed = -1;
  }
}

/// Many edges at a time: values of many points cost less each.
class RootFinder {
 public:
  RootFinder(GridSampler& sampler, const Box3& box) : sampler_(sampler), box_(box) {}

  /// Leaves the surface at point(next).
  void run(std::vector<Bracket>& brackets) {
    for (Bracket& b : brackets) clip(b, box_);
    // The lattice's signs decide; values that say otherwise are those of points on the surface.
    evaluate(brackets, [](Bracket& b, double value) {
      b.at_low = value;
      if (!(value < 0))
        b.finish(0);
      else
        b.next = b.high;
    });
    evaluate(brackets, [](Bracket& b, double value) {
      b.at_high = value;
      if (value < 0)
        b.finish(b.high);
      else
        b.leaves = -1;
    });
    for (int step = 0; step < most_steps; ++step) {
      for (Bracket& b : brackets)
        if (!b.done) choose(b, step);
      if (!evaluate(brackets, narrow)) return;
    }
  }

 private:
  /// False: nothing was left to ask.
  template <class Take>
  bool evaluate(std::vector<Bracket>& brackets, Take take) {
    where_.clear();
    for (const Bracket& b : brackets)
      if (!b.done) where_.push_back(b.point(b.next, box_));
    if (where_.empty()) return false;
    values_.resize(where_.size());
    sampler_.values_at(where_, values_.data());
    std::size_t i = 0;
    for (Bracket& b : brackets)
      if (!b.done) take(b, values_[i++]);
    return true;
  }

  GridSampler& sampler_;
  const Box3& box_;
  std::vector<Vec3> where_;
  std::vector<double> values_;
};

Bracket bracket_of(const Points& points, std::uint32_t owner, unsigned edge) {
  const std::uint32_t other = other_end(points, owner, edge);
  const bool owner_inside = points.sign(owner) == Sign::inside;
  return {.from = points.position(owner_inside ? owner : other), .to = points.position(owner_inside ? other : owner)};
}

/// Cuts around one point of the lattice.
template <class Visit>
void for_each_cut(const Points& points, std::vector<Cut>& cuts, std::uint32_t id, Visit visit) {
  const auto at = [&](std::uint32_t owner, unsigned edge) {
    if (!points.crossed(owner, edge)) return;
    Cut& cut = cuts[points.cut(owner, edge)];
    if (!cut.gone) visit(cut);
  };
  const Index3 i = points.index(id);
  const std::int32_t first = points.is_centre(id) ? -1 : 0;
  for (unsigned e = 0; e < long_edges; ++e) {
    at(id, e);
    if (i[e] > first) at(id - points.stride(id, e), e);
  }
  for (unsigned e = 0; e < short_edges; ++e) {
    if (points.is_centre(id)) {
      at(id, long_edges + e);
    } else {
      const Index3 c{i[0] - static_cast<std::int32_t>(e & 1), i[1] - static_cast<std::int32_t>(e >> 1 & 1),
                     i[2] - static_cast<std::int32_t>(e >> 2 & 1)};
      at(points.centre(c), long_edges + e);
    }
  }
}

}  // namespace

bool find_cuts(const Points& points, const GridSource& source, std::vector<Cut>& cuts, Threads& threads) {
  for (std::uint32_t id = 0, next = 0; id < points.count(); ++id)
    for (std::uint32_t edges = points.crossings(id); edges != 0; edges &= edges - 1)
      cuts[next++] = {.owner = id, .edge = static_cast<std::uint8_t>(std::countr_zero(edges))};
  return threads.ranges("surface", cuts.size(), edges_at_a_time, [&](std::size_t first, std::size_t last) {
    const auto sampler = source.sampler();
    std::vector<Bracket> brackets;
    for (std::size_t c = first; c < last; ++c) brackets.push_back(bracket_of(points, cuts[c].owner, cuts[c].edge));
    RootFinder(*sampler, points.lattice().box).run(brackets);
    for (std::size_t c = first; c < last; ++c) {
      const Bracket& b = brackets[c - first];
      cuts[c].at = b.point(b.next, points.lattice().box);
    }
  });
}

std::vector<Moved> warp(Points& points, std::vector<Cut>& cuts) {
  const double h = points.lattice().spacing;
  std::vector<Moved> moved;
  for (std::uint32_t id = 0; id < points.count(); ++id) {
    if (points.sign(id) == Sign::zero) continue;
    const Vec3 here = points.position(id);
    double closest = HUGE_VAL;
    Vec3 to;
    for_each_cut(points, cuts, id, [&](const Cut& cut) {
      const double reach = h * (cut.edge < long_edges ? close_on_long : close_on_short * short_edge_length);
      const double distance = norm(cut.at - here);
      if (distance >= reach || distance >= closest) return;
      closest = distance;
      to = cut.at;
    });
    if (closest == HUGE_VAL) continue;
    for_each_cut(points, cuts, id, [](Cut& cut) { cut.gone = true; });
    points.set_sign(id, Sign::zero);
    moved.push_back({id, to});
  }
  return moved;
}

}  // namespace meso::implicit::stuffing
