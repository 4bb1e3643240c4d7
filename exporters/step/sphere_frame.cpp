// SPDX-License-Identifier: Apache-2.0
#include "sphere_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "meso/brep/placement.hpp"

namespace meso::step {

using namespace brep;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int samples_of_an_edge = 12, azimuths = 24, spread_axes = 40;
constexpr double clear_enough = 0.02;  // radians

Vec3 unit(Vec3 v) { return (1 / norm(v)) * v; }

using Loop = std::vector<Vec3>;  ///< unit vectors from the sphere's centre, in order

/// A circle's arc, or the poles of another curve, which are near enough to keep clear of it.
std::vector<Vec3> points_along(const EdgeTemplate& edge, Vec3 first, Vec3 last) {
  const auto* circle = std::get_if<Circle>(&edge.curve);
  if (const auto* spline = std::get_if<BSplineCurve>(&edge.curve)) return spline->poles;
  if (circle == nullptr) return {first, last};
  const AxisFrame& f = circle->frame;
  const Vec3 y = cross(f.z, f.x);
  const auto angle = [&](Vec3 p) { return std::atan2(dot(p - f.origin, y), dot(p - f.origin, f.x)); };
  const double from = angle(first);
  double sweep = angle(last) - from;
  while (sweep < 1e-9) sweep += 2 * pi;
  std::vector<Vec3> points;
  for (int i = 0; i <= samples_of_an_edge; ++i) {
    const double a = from + sweep * i / samples_of_an_edge;
    points.push_back(f.origin + circle->radius * (std::cos(a) * f.x + std::sin(a) * y));
  }
  return points;
}

}  // namespace

std::vector<Loop> points_of_loops(const FaceTemplate& face, const Template& geometry, Vec3 centre) {
  std::vector<Loop> loops;
  for (const auto& coedges : face.loops) {
    Loop& loop = loops.emplace_back();
    for (const Coedge& use : coedges) {
      const EdgeTemplate& edge = geometry.edges[use.edge];
      if (edge.degenerate) continue;
      const auto vertex = [&](std::size_t k) {
        return geometry.vertices[edge.vertex[k]] + cell_origin(geometry, edge.vertex_offset[k]);
      };
      std::vector<Vec3> points = points_along(edge, vertex(0), vertex(1));
      if (use.reversed) std::reverse(points.begin(), points.end());
      const Vec3 shift = cell_origin(geometry, use.offset) - centre;
      for (const Vec3& p : points) loop.push_back(unit(p + shift));
    }
  }
  return loops;
}

namespace {

/// Of a loop that does not cross the seam: what lies on its left, if the plane of angles is spread out.
double signed_area(const AxisFrame& frame, const Loop& loop) {
  const Vec3 y = cross(frame.z, frame.x);
  const auto around = [&](Vec3 p) { return std::atan2(-dot(p, y), -dot(p, frame.x)); };  // jumps at the seam
  if (loop.empty()) return 0;
  const double first = around(loop.front());
  double area = 0, at_p = first;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const bool is_last = i + 1 == loop.size();
    const Vec3 p = loop[i], q = is_last ? loop.front() : loop[i + 1];
    const double at_q = is_last ? first : around(q);
    area -= (at_q - at_p) * (dot(p, frame.z) + dot(q, frame.z)) / 2;
    at_p = at_q;
  }
  return area;
}

struct Clearance {
  int crossings = 0;  ///< of the seam, without those of loops around a pole; or a lonely hole that misses it
  double margin = 2;  ///< sine of the angle between poles or seam and the nearest loop
  friend bool operator<(const Clearance& a, const Clearance& b) {
    return a.crossings != b.crossings ? a.crossings > b.crossings : a.margin < b.margin;
  }
};

// A hole that is a face's only loop is read as the border of its inner side, unless it is around a pole. Where it is
// not better than `least`, the margin is only known not to be.
Clearance clearance_of(const AxisFrame& frame, const std::vector<Loop>& loops, bool reversed, const Clearance& least) {
  const Vec3 y = cross(frame.z, frame.x);
  Clearance found;
  for (const Loop& loop : loops) {
    int crossings = 0;
    double beside = 2;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 p = loop[i], q = loop[(i + 1) % loop.size()];
      const double pu = dot(p, frame.x), pw = dot(p, y), qu = dot(q, frame.x), qw = dot(q, y);
      found.margin = std::min(found.margin, std::sqrt(pu * pu + pw * pw));
      if (found.crossings >= least.crossings && found.margin <= least.margin) return found;
      if (pu > 0) beside = std::min(beside, std::fabs(pw));
      if ((pw < 0) != (qw < 0) && pu * std::fabs(qw) + qu * std::fabs(pw) > 0) ++crossings;
    }
    if (crossings == 0) found.margin = std::min(found.margin, beside);
    if (crossings > 1) found.crossings += crossings;
    if (found.crossings > least.crossings || (found.crossings == least.crossings && found.margin <= least.margin))
      return found;
    if (crossings == 0 && loops.size() == 1 && (signed_area(frame, loop) < 0) != reversed) found.crossings += 2;
  }
  return found;
}

/// Sine of the angle between an axis and the nearest point: no frame with this axis has a larger margin.
double margin_of_poles(Vec3 axis, const std::vector<Loop>& loops) {
  double along = 0;
  for (const Loop& loop : loops)
    for (const Vec3& p : loop) along = std::max(along, std::fabs(dot(p, axis)));
  return std::sqrt(std::max(0.0, 1 - along * along));
}

/// Through the middles of holes, and spread over the sphere.
std::vector<Vec3> axes_to_try(const AxisFrame& own, const std::vector<Loop>& loops) {
  std::vector<Vec3> axes{own.z, own.x, cross(own.z, own.x)};
  for (const Loop& loop : loops) {
    Vec3 middle;
    for (const Vec3& p : loop) middle += p;
    if (norm(middle) > 1e-3) axes.push_back(unit(middle));
  }
  static const std::vector<Vec3> spread = [] {
    std::vector<Vec3> all;
    for (int i = 0; i < spread_axes; ++i) {
      const double h = (i + 0.5) / spread_axes, around = pi * (1 + std::sqrt(5.0)) * i, r = std::sqrt(1 - h * h);
      all.push_back({r * std::cos(around), r * std::sin(around), h});
    }
    return all;
  }();
  axes.insert(axes.end(), spread.begin(), spread.end());
  return axes;
}

}  // namespace

AxisFrame clear_frame(const SphereSurface& sphere, const FaceTemplate& face, const Template& geometry) {
  const AxisFrame& own = sphere.frame;
  const std::vector<Loop> loops = points_of_loops(face, geometry, own.origin);
  AxisFrame best = own;
  Clearance clearest = clearance_of(own, loops, face.reversed, {.crossings = std::numeric_limits<int>::max()});
  if (clearest.crossings == 0 && clearest.margin > clear_enough) return own;
  for (const Vec3 z : axes_to_try(own, loops)) {
    constexpr double rounding = 1e-6;
    if (clearest.crossings == 0 && margin_of_poles(z, loops) + rounding < clearest.margin) continue;
    const Vec3 beside = std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 x = unit(beside - dot(beside, z) * z), y = cross(z, x);
    for (int a = 0; a < azimuths; ++a) {
      const double angle = 2 * pi * a / azimuths;
      const AxisFrame frame{own.origin, z, std::cos(angle) * x + std::sin(angle) * y};
      const Clearance clearance = clearance_of(frame, loops, face.reversed, clearest);
      if (clearest < clearance) std::tie(best, clearest) = std::tie(frame, clearance);
    }
  }
  return best;
}

}  // namespace meso::step
