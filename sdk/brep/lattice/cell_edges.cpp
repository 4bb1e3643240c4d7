// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_edges.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }

/// How far a point of a circle is from the frame's x, in the circle's direction.
double angle_on(const Circle& circle, Vec3 p) {
  const Vec3 way = p - circle.frame.origin;
  const double angle = std::atan2(dot(way, cross(circle.frame.z, circle.frame.x)), dot(way, circle.frame.x));
  return angle < 0 ? angle + 2 * pi : angle;
}

Vec3 point_on(const Circle& circle, double angle) {
  const auto& [origin, z, x] = circle.frame;
  return origin + circle.radius * (std::cos(angle) * x + std::sin(angle) * cross(z, x));
}

}  // namespace

std::uint32_t CellEdges::find(Vec3 p) const {
  std::uint32_t best = static_cast<std::uint32_t>(geometry_.vertices.size());
  double least = tolerance_;
  for (std::uint32_t v = 0; v < geometry_.vertices.size(); ++v)
    if (const double away = norm(geometry_.vertices[v] - p); away <= least) {
      best = v;
      least = away;
    }
  return best;
}

std::uint32_t CellEdges::vertex(Vec3 p) {
  const std::uint32_t known = find(p);
  if (known == geometry_.vertices.size()) geometry_.vertices.push_back(p);
  return known;
}

Coedge CellEdges::known_or(const EdgeTemplate& edge, Vec3 middle) {
  for (std::uint32_t e = 0; e < geometry_.edges.size(); ++e) {
    const auto& ends = geometry_.edges[e].vertex;
    const bool same = ends == edge.vertex, back = ends[0] == edge.vertex[1] && ends[1] == edge.vertex[0];
    if ((!same && !back) || norm(middles_[e] - middle) > 10 * tolerance_) continue;
    if (edge.vertex[0] != edge.vertex[1]) return {.edge = e, .reversed = !same};
    return {
        .edge = e,
        .reversed = dot(std::get<Circle>(geometry_.edges[e].curve).frame.z, std::get<Circle>(edge.curve).frame.z) < 0};
  }
  geometry_.edges.push_back(edge);
  middles_.push_back(middle);
  return {.edge = static_cast<std::uint32_t>(geometry_.edges.size()) - 1};
}

Coedge CellEdges::line(std::uint32_t from, std::uint32_t to) {
  return known_or({.curve = Line{at(from), unit(at(to) - at(from))}, .vertex = {from, to}}, 0.5 * (at(from) + at(to)));
}

Coedge CellEdges::arc(Vec3 centre, Vec3 axis, double radius, std::uint32_t from, std::uint32_t to) {
  const Vec3 way = at(from) - centre;
  const Circle circle{{centre, -axis, unit(way - dot(way, axis) * axis)}, radius};
  const double sweep = from == to ? 2 * pi : angle_on(circle, at(to));
  return known_or({.curve = circle, .vertex = {from, to}}, point_on(circle, sweep / 2));
}

std::vector<Vec3> CellEdges::points(const Coedge& use, int count) const {
  const EdgeTemplate& edge = geometry_.edges[use.edge];
  const Vec3 from = at(edge.vertex[0]), to = at(edge.vertex[1]);
  const auto* circle = std::get_if<Circle>(&edge.curve);
  const double sweep = circle == nullptr ? 0 : edge.vertex[0] == edge.vertex[1] ? 2 * pi : angle_on(*circle, to);
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(use.reversed ? count - i : i) / count;
    out.push_back(circle == nullptr ? (1 - t) * from + t * to : point_on(*circle, t * sweep));
  }
  return out;
}

std::vector<std::vector<Coedge>> chained(const CellEdges& edges, std::span<const Coedge> uses) {
  std::map<std::uint32_t, std::size_t> starts;
  for (std::size_t u = 0; u < uses.size(); ++u)
    if (!starts.emplace(edges.start(uses[u]), u).second) return {};
  std::vector<bool> taken(uses.size(), false);
  std::vector<std::vector<Coedge>> loops;
  for (std::size_t first = 0; first < uses.size(); ++first) {
    if (taken[first]) continue;
    auto& loop = loops.emplace_back();
    for (std::size_t u = first; !taken[u];) {
      taken[u] = true;
      loop.push_back(uses[u]);
      const auto next = starts.find(edges.end(uses[u]));
      if (next == starts.end()) return {};
      u = next->second;
    }
    if (edges.end(loop.back()) != edges.start(loop.front())) return {};
  }
  return loops;
}

}  // namespace meso::brep
