// SPDX-License-Identifier: Apache-2.0
#include "unrolled_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace meso::brep {
namespace {

using Index = std::uint32_t;
using Corners = std::array<Index, 3>;
using Polygon = std::vector<Index>;

/// The points of all loops: a point where loops touch each other or themselves has one number.
struct Border {
  std::vector<BorderPoint> points;
  std::vector<Polygon> loops;
};

Border border_of(const std::vector<BorderLoop>& loops) {
  constexpr double same_parameters = 1e-6;  // of what the border takes up
  PlanePoint low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (const BorderLoop& loop : loops)
    for (const BorderPoint& p : loop)
      for (std::size_t i = 0; i < 2; ++i) {
        low[i] = std::fmin(low[i], p.at[i]);
        high[i] = std::fmax(high[i], p.at[i]);
      }
  Border out;
  std::map<std::tuple<double, double, double>, std::vector<Index>> known;
  for (const BorderLoop& loop : loops) {
    Polygon& polygon = out.loops.emplace_back();
    for (const BorderPoint& p : loop) {
      std::vector<Index>& here = known[{p.point.x, p.point.y, p.point.z}];
      const auto same = std::ranges::find_if(here, [&](Index n) {
        const PlanePoint& at = out.points[n].at;
        return std::fabs(at[0] - p.at[0]) <= same_parameters * (high[0] - low[0]) &&
               std::fabs(at[1] - p.at[1]) <= same_parameters * (high[1] - low[1]);
      });
      if (same == here.end()) {
        here.push_back(static_cast<Index>(out.points.size()));
        polygon.push_back(here.back());
        out.points.push_back(p);
      } else {
        polygon.push_back(*same);
      }
    }
  }
  return out;
}

/// Lengths along the parameters, on average over the border.
std::vector<PlanePoint> scaled(const GeomAdaptor_Surface& surface, const std::vector<BorderPoint>& points) {
  double along_u = 0, along_v = 0;
  for (const BorderPoint& p : points) {
    gp_Pnt at;
    gp_Vec u, v;
    surface.D1(p.at[0], p.at[1], at, u, v);
    along_u += u.Magnitude() / static_cast<double>(points.size());
    along_v += v.Magnitude() / static_cast<double>(points.size());
  }
  std::vector<PlanePoint> out;
  for (const BorderPoint& p : points) out.push_back({along_u * p.at[0], along_v * p.at[1]});
  return out;
}

/// Around the apex, which must not be on the border or beyond it.
std::vector<PlanePoint> unrolled(const gp_Cone& cone, const std::vector<BorderPoint>& points) {
  const double slope = std::sin(cone.SemiAngle());
  const double middle = (points.front().at[0] + points[points.size() / 2].at[0]) / 2;
  std::vector<PlanePoint> out;
  for (const BorderPoint& p : points) {
    const double from_apex = p.at[1] + cone.RefRadius() / slope;
    const double turn = -std::copysign(slope, from_apex) * (p.at[0] - middle);
    out.push_back({from_apex * std::cos(turn), from_apex * std::sin(turn)});
    if ((from_apex > 0) != (points.front().at[1] + cone.RefRadius() / slope > 0)) return {};
  }
  return out;
}

/// Planes in which the border's polygons go round the face, the best first.
std::vector<std::vector<PlanePoint>> planes_of(const Handle(Geom_Surface) & surface,
                                               const std::vector<BorderPoint>& points) {
  const GeomAdaptor_Surface adaptor(surface);
  std::vector<std::vector<PlanePoint>> out;
  if (adaptor.GetType() == GeomAbs_Cone)
    if (auto plane = unrolled(adaptor.Cone(), points); !plane.empty()) out.push_back(std::move(plane));
  out.push_back(scaled(adaptor, points));
  return out;
}

double turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double length(const PlanePoint& a, const PlanePoint& b) { return std::hypot(b[0] - a[0], b[1] - a[1]); }

/// How far a clockwise triangle reaches over its longest side.
double height_of_fold(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double over = -turn(a, b, c);
  if (over <= 0) return 0;
  const double longest = std::max({length(a, b), length(b, c), length(c, a)});
  return longest > 0 ? over / longest : 0;
}

/// One polygon that goes to each further loop and back along the shortest way.
Polygon joined(const std::vector<PlanePoint>& plane, std::vector<Polygon> loops) {
  Polygon out = std::move(loops.front());
  loops.erase(loops.begin());
  while (!loops.empty()) {
    double shortest = HUGE_VAL;
    std::size_t loop = 0, from = 0, to = 0;
    for (std::size_t l = 0; l < loops.size(); ++l)
      for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t k = 0; k < loops[l].size(); ++k)
          if (const double way = length(plane[out[i]], plane[loops[l][k]]); way < shortest)
            std::tie(shortest, loop, from, to) = std::tuple(way, l, i, k);
    Polygon& next = loops[loop];
    std::ranges::rotate(next, next.begin() + static_cast<std::ptrdiff_t>(to));
    next.push_back(next.front());
    next.push_back(out[from]);
    out.insert(out.begin() + static_cast<std::ptrdiff_t>(from) + 1, next.begin(), next.end());
    loops.erase(loops.begin() + static_cast<std::ptrdiff_t>(loop));
  }
  return out;
}

/// Of all triangulations of a polygon the one that is folded least, and of those the one with the shortest sides: each
/// part of the polygon beyond a diagonal is done once (Barequet and Sharir, Comput. Aided Geom. Des. 12, 1995).
std::optional<UnrolledMesh> least_folded(const std::vector<PlanePoint>& plane, const Polygon& polygon) {
  constexpr std::size_t most_points = 1000;  // a second
  constexpr double price_of_fold = 1e4;
  const std::size_t n = polygon.size();
  if (n > most_points) return {};
  UnrolledMesh out;
  if (n < 3) return out;
  const auto at = [&](std::size_t i) -> const PlanePoint& { return plane[polygon[i]]; };
  std::vector<double> side(n * n);  // looked up n times
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) side[i * n + k] = length(at(i), at(k));
  std::vector<double> price(n * n, 0);
  std::vector<std::size_t> tip(n * n, 0);
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double least = HUGE_VAL;
      for (std::size_t m = i + 1; m < k; ++m) {
        const double sum = price[i * n + m] + price[m * n + k] + price_of_fold * height_of_fold(at(i), at(m), at(k)) +
                           side[i * n + m] + side[m * n + k];
        if (sum < least) std::tie(least, tip[i * n + k]) = std::tuple(sum, m);
      }
      price[i * n + k] = least;
    }
  if (!std::isfinite(price[n - 1])) return {};  // points without a place have no triangles
  std::vector<std::pair<std::size_t, std::size_t>> pending{{0, n - 1}};
  while (!pending.empty()) {
    const auto [i, k] = pending.back();
    pending.pop_back();
    if (k < i + 2) continue;
    const std::size_t m = tip[i * n + k];
    out.triangles.push_back({polygon[i], polygon[m], polygon[k]});
    pending.insert(pending.end(), {{i, m}, {m, k}});
  }
  return out;
}

/// Numbers through all loops for those of the border.
void count_through(UnrolledMesh& mesh, const Border& border) {
  std::vector<Index> number(border.points.size());
  Index next = 0;
  for (const Polygon& loop : border.loops)
    for (const Index p : loop) number[p] = next++;
  for (Corners& t : mesh.triangles)
    for (Index& corner : t) corner = number[corner];
}

}  // namespace

double fold_of(const Handle(Geom_Surface) & surface, std::span<const BorderPoint> points,
               std::span<const Corners> triangles) {
  double fold = 0;
  for (const Corners& t : triangles) {
    const BorderPoint &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    gp_Pnt at;
    gp_Vec u, v;
    surface->D1((a.at[0] + b.at[0] + c.at[0]) / 3, (a.at[1] + b.at[1] + c.at[1]) / 3, at, u, v);
    const Vec3 normal = to_vec(u.Crossed(v).XYZ());
    if (norm(normal) == 0) continue;  // a pole
    const Vec3 n = normal / norm(normal);
    const double twice = -dot(n, cross(b.point - a.point, c.point - a.point));
    if (twice <= 0) continue;
    const auto along = [&](Vec3 side) { return norm(side - dot(side, n) * n); };
    const double longest = std::max({along(b.point - a.point), along(c.point - b.point), along(a.point - c.point)});
    if (longest > 0) fold = std::fmax(fold, twice / longest);
  }
  return fold;
}

std::optional<UnrolledMesh> unrolled_mesh(const Handle(Geom_Surface) & surface, const std::vector<BorderLoop>& loops) {
  const Border border = border_of(loops);
  if (border.points.empty()) return {};
  const auto planes = planes_of(surface, border.points);
  std::optional<UnrolledMesh> best;
  for (const auto& plane : planes)
    if (auto triangles = triangulate_between(plane, border.loops)) {
      best = UnrolledMesh{.triangles = std::move(*triangles)};
      break;
    }
  for (std::size_t i = 0; !best && i < planes.size(); ++i)
    if (!border.loops.empty()) best = least_folded(planes[i], joined(planes[i], border.loops));
  if (!best) return {};
  best->fold = fold_of(surface, border.points, best->triangles);
  count_through(*best, border);
  return best;
}

}  // namespace meso::brep
