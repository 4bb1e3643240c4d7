// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lattice/union_find.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

/// How far the arc goes, clockwise.
double sweep_of(const SphereArc& arc) {
  if (arc.is_whole) return 2 * pi;
  const Vec3 x = unit(arc.from - dot(arc.from, arc.axis) * arc.axis), y = cross(x, arc.axis);
  const double angle = std::atan2(dot(arc.to, y), dot(arc.to, x));
  return angle > 0 ? angle : angle + 2 * pi;
}

/// The point of a circle nearest to `p`, as a turn from the arc's beginning.
double turn_to(const SphereArc& arc, Vec3 p) {
  const Vec3 x = unit(arc.from - dot(arc.from, arc.axis) * arc.axis), y = cross(x, arc.axis);
  const double angle = std::atan2(dot(p, y), dot(p, x));
  return angle < 0 ? angle + 2 * pi : angle;
}

/// Loops of circles that touch, directly or by others, bound a face each; a face between several such sets of circles
/// is on the inner side of one loop of each.
class FaceFinder {
 public:
  explicit FaceFinder(const std::vector<SphereCircle>& circles) : circles_(circles) { trace(); }

  std::vector<std::vector<SphereLoop>> faces() {
    std::vector<std::vector<SphereLoop>> out;
    std::vector<std::int32_t> face_of(loops_.size(), -1);
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      if (face_of[l] < 0) {
        face_of[l] = static_cast<std::int32_t>(out.size());
        out.emplace_back();
        for (std::size_t m = l + 1; m < loops_.size(); ++m)
          if (face_of[m] < 0 && are_one_face(l, m)) face_of[m] = face_of[l];
      }
      out[static_cast<std::size_t>(face_of[l])].push_back(loops_[l]);
    }
    return out;
  }

 private:
  void trace() {
    UnionFind sets(circles_.size());
    for (std::uint32_t c = 0; c < circles_.size(); ++c) {
      loop_of_.emplace_back(circles_[c].arcs.size(), -1);
      for (const auto& next : circles_[c].next) sets.join(c, next[0]);
    }
    for (std::uint32_t c = 0; c < circles_.size(); ++c)
      for (std::uint32_t a = 0; a < circles_[c].arcs.size(); ++a) {
        if (loop_of_[c][a] >= 0) continue;
        SphereLoop& loop = loops_.emplace_back();
        for (std::array at{c, a}; loop_of_[at[0]][at[1]] < 0; at = circles_[at[0]].next[at[1]]) {
          loop_of_[at[0]][at[1]] = static_cast<std::int32_t>(loops_.size()) - 1;
          loop.push_back(circles_[at[0]].arcs[at[1]]);
        }
        set_of_loop_.push_back(sets.root(c));
      }
    for (std::uint32_t c = 0; c < circles_.size(); ++c) set_of_circle_.push_back(sets.root(c));
  }

  /// The loop of a set of circles on whose left the other set lies, which `p` is a point of.
  [[nodiscard]] std::int32_t loop_around(std::uint32_t set, Vec3 p) const {
    std::int32_t found = -1;
    double least = 0;
    for (std::uint32_t c = 0; c < circles_.size(); ++c) {
      if (set_of_circle_[c] != set) continue;
      const SphereArc& first = circles_[c].arcs.front();
      const double away = std::acos(std::clamp(dot(p, first.axis), -1.0, 1.0)) - first.angle;
      if (found >= 0 && away >= least) continue;
      least = away;
      std::size_t arc = 0;
      if (circles_[c].arcs.size() > 1) {
        const double turn = turn_to(first, p);
        double passed = 0;
        while (arc + 1 < circles_[c].arcs.size() && turn > (passed += sweep_of(circles_[c].arcs[arc]))) ++arc;
      }
      found = loop_of_[c][arc];
    }
    return found;
  }

  [[nodiscard]] bool are_one_face(std::size_t l, std::size_t m) const {
    const std::uint32_t own = set_of_loop_[l], other = set_of_loop_[m];
    if (own == other) return false;
    const Vec3 p = loops_[l].front().from, q = loops_[m].front().from;
    if (loop_around(own, q) != static_cast<std::int32_t>(l) || loop_around(other, p) != static_cast<std::int32_t>(m))
      return false;
    return std::ranges::all_of(set_of_circle_, [&](std::uint32_t set) {
      return set == own || set == other || loop_around(set, p) == loop_around(set, q);
    });
  }

  const std::vector<SphereCircle>& circles_;
  std::vector<SphereLoop> loops_;
  std::vector<std::uint32_t> set_of_loop_, set_of_circle_;
  std::vector<std::vector<std::int32_t>> loop_of_;
};

struct BoundarySums {
  Vec3 first, second, third;  ///< integrals of nu, n nu, n^2 nu ds, nu the outward conormal
};

/// Gauss-Legendre over eighths of a turn at most: integrands are polynomials of degree 3 in sine and cosine.
void add_arc(const SphereArc& arc, double sweep, BoundarySums& sums) {
  constexpr std::array<double, 4> node{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr std::array<double, 4> weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                         0.1012285362903763};
  const Vec3 x = unit(arc.from - dot(arc.from, arc.axis) * arc.axis), y = cross(x, arc.axis);
  const double sine = std::sin(arc.angle), cosine = std::cos(arc.angle);
  const int parts = std::max(1, static_cast<int>(std::ceil(sweep / (pi / 4) - 1e-9)));
  const double half = sweep / parts / 2;
  for (int part = 0; part < parts; ++part)
    for (std::size_t k = 0; k < 8; ++k) {
      const double t = (2 * part + 1 + (k % 2 == 0 ? node[k / 2] : -node[k / 2])) * half;
      const Vec3 outward = std::cos(t) * x + std::sin(t) * y;
      const Vec3 n = cosine * arc.axis + sine * outward, nu = sine * arc.axis - cosine * outward;
      const double ds = weight[k / 2] * half * sine;
      for (std::size_t i = 0; i < 3; ++i) {
        sums.first[i] += nu[i] * ds;
        sums.second[i] += n[i] * nu[i] * ds;
        sums.third[i] += n[i] * n[i] * nu[i] * ds;
      }
    }
}

/// The angle by which the seam and its poles pass a circle.
double clearance(const AxisFrame& frame, Vec3 y, const SphereArc& circle) {
  const double up = dot(circle.axis, frame.z), front = dot(circle.axis, frame.x);
  const double to_pole = std::acos(std::clamp(up, -1.0, 1.0)), nearest = std::min(to_pole, pi - to_pole);
  // A pole in a circle is the last resort: readers take such a loop for the border of the wrong side.
  if (nearest < circle.angle) return nearest - circle.angle - pi;
  const double to_seam = front > 0 ? std::asin(std::min(1.0, std::fabs(dot(circle.axis, y)))) : nearest;
  return to_seam - circle.angle;
}

double clearance(const AxisFrame& frame, const std::vector<SphereLoop>& loops) {
  const Vec3 y = cross(frame.z, frame.x);
  double least = pi;
  for (const SphereLoop& loop : loops)
    for (const SphereArc& arc : loop) least = std::min(least, clearance(frame, y, arc));
  return least;
}

}  // namespace

std::vector<std::vector<SphereLoop>> sphere_faces(const std::vector<SphereCircle>& circles) {
  return FaceFinder(circles).faces();
}

// Where circles touch, the way goes back: the turn is pi, never -pi.
double turn_between(const SphereArc& arc, const SphereArc& next) {
  const Vec3 before = cross(arc.to, arc.axis), after = cross(next.from, next.axis);
  const double turn = std::atan2(dot(arc.to, cross(before, after)), dot(before, after));
  return turn < 1e-4 - pi ? turn + 2 * pi : turn;
}

// On the unit sphere n_i, n_i^2 - 1/3 and n_i^3 - 3/5 n_i are eigenfunctions of the Laplacian (-2, -6, -12), so their
// integrals are those of their normal derivatives along the boundary; the area is that of Gauss and Bonnet.
FaceMoments sphere_moments(Vec3 centre, double radius, const std::vector<SphereLoop>& loops) {
  BoundarySums sums;
  double area = 2 * pi * (2 - static_cast<double>(loops.size()));
  for (const SphereLoop& loop : loops)
    for (std::size_t a = 0; a < loop.size(); ++a) {
      const SphereArc& arc = loop[a];
      const double sweep = sweep_of(arc);
      add_arc(arc, sweep, sums);
      area += std::cos(arc.angle) * sweep - turn_between(arc, loop[(a + 1) % loop.size()]);
    }
  FaceMoments moments{.area = radius * radius * area};
  for (std::size_t i = 0; i < 3; ++i) {
    const double n1 = -sums.first[i] / 2, n2 = (area - sums.second[i]) / 3, n3 = n1 / 2 - sums.third[i] / 4;
    const double c = centre[i], square = radius * radius;
    moments.vector_area[i] = square * n1;
    moments.volume_moment[i] = square * (c * n1 + radius * n2);
    moments.centroid_moment[i] = square * (c * c / 2 * n1 + c * radius * n2 + square / 2 * n3);
  }
  return moments;
}

AxisFrame clear_axes(Vec3 centre, const std::vector<SphereLoop>& loops, AxisFrame& hint) {
  // What two struts in a row leave of a ball is a zone. About their axis its borders are exact for every reader.
  if (loops.size() == 2 && dot(loops[0][0].axis, loops[1][0].axis) < 1e-12 - 1) {
    const SphereArc& arc = loops[0][0];
    return {centre, arc.axis, unit(arc.from - dot(arc.from, arc.axis) * arc.axis)};
  }
  constexpr double clear_enough = 0.03;
  constexpr int azimuths = 24;
  AxisFrame best = hint;
  double most = clearance(best, loops);
  const auto consider = [&](Vec3 z, Vec3 x) {
    const AxisFrame frame{centre, z, x};
    const double clear = clearance(frame, loops);
    if (clear > most) std::tie(best, most) = std::pair(frame, clear);
  };
  Vec3 middle;
  for (const SphereLoop& loop : loops)
    for (const SphereArc& arc : loop) middle += arc.from;
  if (most < clear_enough && norm(middle) > 1e-3) consider(across(middle), -unit(middle));
  std::vector<Vec3> poles{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  for (const SphereLoop& loop : loops)
    for (const SphereArc& arc : loop) poles.push_back(arc.axis);
  for (std::size_t p = 0; p < poles.size() && most < clear_enough; ++p) {
    const Vec3 z = poles[p], x = across(z), y = cross(z, x);
    for (int a = 0; a < azimuths; ++a) {
      const double angle = 2 * pi * a / azimuths;
      consider(z, std::cos(angle) * x + std::sin(angle) * y);
    }
  }
  best.origin = centre;
  return hint = best;
}

AxisFrame axes_across(Vec3 centre, const SphereLoop& loop) {
  Vec3 area;
  for (const SphereArc& arc : loop) area += cross(arc.from, arc.to);
  return {centre, across(area), -unit(area)};
}

}  // namespace meso::brep
