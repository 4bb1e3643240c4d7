// SPDX-License-Identifier: Apache-2.0
// Where new points of a mesh go, and what is done where halving edges leads nowhere.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "crease_finder.hpp"
#include "refine_mesh.hpp"

namespace meso::implicit {
namespace {

Vec3 way_of(const PointNearSurface& from, const Foot& foot) {
  const Vec3 way = foot.point - from.point;
  return norm(way) > 0 ? way : foot.gradient;
}

/// Its height over its longest side.
double width_of(Vec3 a, Vec3 b, Vec3 c) {
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return norm(cross(b - a, c - a)) / (longest * longest);
}

}  // namespace

struct RefinableMesh::Flip {
  Edge edge;  // of the one triangle
  std::uint32_t other;
  std::uint8_t other_side;
  std::uint32_t c, d;  // the corners that are not on it
};

bool RefinableMesh::was_halved_at(std::uint32_t point, Ends ends) const {
  return point < halved_.size() && halved_[point] == Ends{std::min(ends[0], ends[1]), std::max(ends[0], ends[1])};
}

// The edges that are too far, once each.
std::vector<RefinableMesh::Flip> RefinableMesh::possible_flips(double tolerance) const {
  constexpr double narrow = 1e-3;
  std::vector<Edge> far;
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::uint8_t side = 0; side < 3; ++side) {
      if (!(std::fabs(known_[t].edge[side]) > tolerance)) continue;
      const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
      far.push_back({std::min(a, b), std::max(a, b), t, side});
    }
  std::sort(far.begin(), far.end());
  std::vector<Flip> flips;
  for (std::size_t e = 0; e + 1 < far.size(); e += 2) {  // the mesh is closed: every edge twice
    const Edge &one = far[e], &other = far[e + 1];
    const std::uint32_t c = mesh_.triangles[one.triangle][(one.side + 2) % 3];
    const std::uint32_t d = mesh_.triangles[other.triangle][(other.side + 2) % 3];
    if (c == d || (planes_[one.a] & planes_[one.b]) != 0) continue;
    // On one sheet, halves are nearer.
    const std::array<std::uint32_t, 4> corners{one.a, one.b, c, d};
    bool turns = false;
    for (std::size_t i = 1; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 p = gradients_[corners[i]], q = gradients_[corners[j]];
        turns = turns || !(dot(p, q) >= 0.9 * norm(p) * norm(q));
      }
    // Of an edge to a vertex that was put on another, the other diagonal may be that one: it would be halved again, and
    // so on in turn.
    if (was_halved_at(one.a, {c, d}) || was_halved_at(one.b, {c, d})) continue;
    const auto width = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
      return width_of(mesh_.points[p], mesh_.points[q], mesh_.points[r]);
    };
    const double before = std::min(width(one.a, one.b, c), width(one.a, one.b, d));
    const bool stays_wide = std::min(width(one.a, c, d), width(one.b, c, d)) >= std::min(narrow, before);
    if (turns && stays_wide) flips.push_back({one, other.triangle, other.side, c, d});
  }
  return flips;
}

// Triangles a b c and b a d become a d c and b c d.
void RefinableMesh::turn(const Flip& flip) {
  const std::uint32_t t = flip.edge.triangle, u = flip.other;
  const std::uint32_t a = mesh_.triangles[t][flip.edge.side], b = mesh_.triangles[t][(flip.edge.side + 1U) % 3];
  const auto of_one = [&](std::size_t i) { return known_[t].edge[(flip.edge.side + i) % 3]; };
  const auto of_other = [&](std::size_t i) { return known_[u].edge[(flip.other_side + i) % 3]; };
  const auto at_one = [&](std::size_t i) { return known_[t].farthest_at[(flip.edge.side + i) % 3]; };
  const auto at_other = [&](std::size_t i) { return known_[u].farthest_at[(flip.other_side + i) % 3]; };
  const Known one{.edge = {of_other(1), unknown, of_one(2)}, .farthest_at = {at_other(1), 4, at_one(2)}},
      other{.edge = {of_one(1), unknown, of_other(2)}, .farthest_at = {at_one(1), 4, at_other(2)}};
  mesh_.triangles[t] = {a, flip.d, flip.c};
  mesh_.triangles[u] = {b, flip.c, flip.d};
  known_[t] = one;
  known_[u] = other;
}

// Those all of whose points are within the tolerance. What is asked of a point takes more memory than a flip.
template <class Points>
void RefinableMesh::keep_near(std::vector<Flip>& flips, double tolerance, Points points_of) {
  std::vector<Flip> kept;
  std::vector<PointNearSurface> asked;
  std::vector<double> distances;
  for (std::size_t i = 0; i < flips.size();) {
    const std::size_t first = i;
    asked.clear();
    for (; i < flips.size() && asked.size() < asked_at_once; ++i) {
      const std::size_t begin = asked.size();
      points_of(flips[i], asked);
      for (std::size_t n = begin; n < asked.size(); ++n)
        asked[n].ahead = normal_of(flips[i].edge.triangle) + normal_of(flips[i].other);
    }
    feet_.distances(asked, tolerance, distances);
    const std::size_t each = asked.size() / (i - first);
    for (std::size_t f = first; f < i; ++f) {
      const auto of_flip = std::span(distances).subspan(each * (f - first), each);
      if (std::ranges::all_of(of_flip, [&](double d) { return d <= tolerance; })) kept.push_back(flips[f]);
    }
  }
  flips = std::move(kept);
}

// Where neighbours have come to a crease, an edge between its sheets is left over that goes through nothing or through
// the solid: the other diagonal of its two triangles does not.
void RefinableMesh::flip(double tolerance) {
  if (smooth_) return;
  std::vector<Flip> flips = possible_flips(tolerance);
  // The middles of the new edge and of its triangles; then the rest of the edge, of the few that are left.
  keep_near(flips, tolerance, [&](const Flip& f, std::vector<PointNearSurface>& asked) {
    asked.push_back(middle_of(f.c, f.d));
    for (const std::uint32_t end : {f.edge.a, f.edge.b}) {
      const double most = norm(mesh_.points[end] - mesh_.points[f.c]) + norm(mesh_.points[end] - mesh_.points[f.d]);
      asked.push_back({.point = (mesh_.points[f.c] + mesh_.points[f.d] + mesh_.points[end]) / 3, .most = most});
    }
  });
  keep_near(flips, tolerance, [&](const Flip& f, std::vector<PointNearSurface>& asked) {
    for (const double share : {0.125, 0.25, 0.375, 0.625, 0.75, 0.875}) asked.push_back(between(f.c, f.d, share));
  });
  if (flips.empty()) return;
  std::vector<char> marked(mesh_.points.size(), 0), turned(mesh_.triangles.size(), 0);
  for (const Flip& f : flips) marked[f.c] = marked[f.d] = 1;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;  // no edge may be there twice
  for (const auto& t : mesh_.triangles)
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t a = t[side], b = t[(side + 1) % 3];
      if (a < b && marked[a] != 0 && marked[b] != 0) edges.emplace(a, b);
    }
  for (const Flip& f : flips) {
    if (turned[f.edge.triangle] != 0 || turned[f.other] != 0) continue;
    if (!edges.emplace(std::min(f.c, f.d), std::max(f.c, f.d)).second) continue;
    turn(f);
    turned[f.edge.triangle] = turned[f.other] = 1;
  }
  measure(tolerance);
}

// All of whose sides are on the surface, but not what is between them: it cuts a corner off, or is a bridge.
bool RefinableMesh::is_bridge(std::uint32_t triangle) const {
  const Known& known = known_[triangle];
  const auto& corners = mesh_.triangles[triangle];
  double longest = 0;
  for (std::size_t side = 0; side < 3; ++side) {
    longest = std::max(longest, norm(mesh_.points[corners[side]] - mesh_.points[corners[(side + 1) % 3]]));
    if (std::fabs(known.edge[side]) > std::fabs(known.middle) / 2) return false;
  }
  return !smooth_ && std::fabs(known.middle) > 0.1 * longest;
}

// Into three, by the corner in which the sheets of its sides meet, or a point on the surface before or behind the
// middle.
void RefinableMesh::divide(std::span<const std::uint32_t> triangles, double tolerance) {
  std::vector<PointNearSurface> middles;
  std::vector<Ray> rays;
  std::vector<Sheets> corners;
  for (const std::uint32_t t : triangles) {
    const Vec3 normal = normal_of(t);
    middles.push_back(middle_of(t));
    middles.back().slope = 0;
    corners.push_back({.start = middles.back().point, .count = 3, .reach = 1.5 * feet_.cell()});
    for (std::size_t side = 0; side < 3; ++side)
      corners.back().at[side] =
          (mesh_.points[mesh_.triangles[t][side]] + mesh_.points[mesh_.triangles[t][(side + 1) % 3]]) / 2;
    rays.push_back({middles.back().point, 2 * feet_.cell() / norm(normal) * normal});
  }
  std::vector<Foot> feet;
  feet_.feet(middles, tolerance / 20, feet);
  feet_.shoot(rays, tolerance / 20);
  find_creases(corners, near_surface * tolerance, feet_);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto is_free = [&](Vec3 place) {
      double nearest = HUGE_VAL;
      for (const std::uint32_t p : mesh_.triangles[triangles[i]])
        nearest = std::min(nearest, norm(place - mesh_.points[p]));
      return nearest > 0.2 * middles[i].most;
    };
    if (corners[i].found && is_free(corners[i].crease))
      feet[i] = {corners[i].crease, 0, {}};
    else if (rays[i].hit && is_free(rays[i].from))
      feet[i] = {rays[i].from, 0, {}};
  }
  const auto first = static_cast<std::uint32_t>(mesh_.points.size());
  add_points(middles, feet, tolerance);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = mesh_.triangles[triangles[i]];
    const auto edge = known_[triangles[i]].edge;
    mesh_.triangles[triangles[i]] = {a, b, first + i};
    known_[triangles[i]] = {.edge = {edge[0], unknown, unknown}};
    mesh_.triangles.push_back({b, c, first + i});
    known_.push_back({.edge = {edge[1], unknown, unknown}});
    mesh_.triangles.push_back({c, a, first + i});
    known_.push_back({.edge = {edge[2], unknown, unknown}});
  }
}

// Where it is not known, it is taken here.
void RefinableMesh::take_gradients(std::span<const Foot> feet, std::vector<Vec3>& gradients) {
  std::vector<Vec3> points, slopes;
  for (std::size_t i = 0; i < feet.size(); ++i)
    if (norm(gradients[i]) == 0) points.push_back(feet[i].point);
  std::vector<double> values;
  feet_.slopes(points, slopes, values);
  auto next = slopes.begin();
  for (Vec3& gradient : gradients)
    if (norm(gradient) == 0) gradient = *next++;
}

// Those that are not on the surface.
void RefinableMesh::mend_feet(std::span<const PointNearSurface> from, std::span<Foot> feet, double tolerance) {
  std::vector<Vec3> points, ways;
  for (std::size_t i = 0; i < feet.size(); ++i)
    points.push_back(feet[i].point), ways.push_back(way_of(from[i], feet[i]));
  std::vector<char> on_surface;
  feet_.check(points, ways, near_surface * tolerance, on_surface);
  std::vector<PointNearSurface> lost;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (on_surface[i] != 0 || from[i].planes != 0) continue;
    lost.push_back(from[i]);
    which.push_back(i);
  }
  const std::vector<Ray> found = feet_.search(lost, tolerance / 20);
  for (std::size_t n = 0; n < found.size(); ++n)
    if (found[n].hit) feet[which[n]] = {found[n].from, 0, {}};
}

// Whether they are on the surface is looked at on the way that they came: on from a wedge's tip there is nothing.
void RefinableMesh::add_points(std::span<const PointNearSurface> from, std::span<Foot> feet, double tolerance) {
  if (!smooth_) mend_feet(from, feet, tolerance);
  for (Foot& foot : feet)
    for (std::size_t axis = 0; axis < 3; ++axis)
      foot.point[axis] = std::clamp(foot.point[axis], box_.min[axis], box_.max[axis]);
  std::vector<Vec3> points, gradients, ways;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    points.push_back(feet[i].point), gradients.push_back(feet[i].gradient);
    ways.push_back(way_of(from[i], feet[i]));
    planes_.push_back(planes_of(box_, points.back()));
    distances_.push_back(static_cast<float>(from[i].most + norm(points.back() - from[i].point)));
  }
  const std::size_t first = mesh_.points.size();
  mesh_.points.insert(mesh_.points.end(), points.begin(), points.end());
  take_gradients(feet, gradients);
  gradients_.insert(gradients_.end(), gradients.begin(), gradients.end());
  measure_new_points(first, ways, tolerance);
}

void RefinableMesh::measure_new_points(std::size_t first, std::span<const Vec3> ways, double tolerance) {
  const std::span<const Vec3> points = std::span(mesh_.points).subspan(first);
  if (smooth_) {
    std::fill(distances_.begin() + static_cast<std::ptrdiff_t>(first), distances_.end(), 0.0F);
    return;
  }
  for (const double share : {near_surface, 0.05}) {
    std::vector<char> on_surface;
    feet_.check(points, ways, share * tolerance, on_surface);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (on_surface[i] != 0) distances_[first + i] = static_cast<float>(share * tolerance);
  }
  std::vector<PointNearSurface> off;
  std::vector<std::size_t> which;
  for (std::size_t i = first; i < mesh_.points.size(); ++i) {
    if (distances_[i] <= near_surface * tolerance) continue;
    const auto most = static_cast<double>(distances_[i]);
    off.push_back({.point = mesh_.points[i], .planes = planes_[i], .ahead = ways[i - first], .most = most});
    which.push_back(i);
  }
  std::vector<double> distances;
  feet_.distances(off, near_surface * tolerance, distances);
  for (std::size_t n = 0; n < which.size(); ++n) distances_[which[n]] = static_cast<float>(distances[n]);
}

// From side to side of a wall or wedge.
bool RefinableMesh::goes_through(const Edge& edge) const {
  const Vec3 a = gradients_[edge.a], b = gradients_[edge.b];
  return dot(a, b) < -0.5 * norm(a) * norm(b);
}

// Beside an end of the edge or a corner before it: there, a point would leave another edge that is as far.
bool RefinableMesh::is_taken(const Cut& cut, Vec3 place) const {
  const Vec3 a = mesh_.points[cut.edge.a], b = mesh_.points[cut.edge.b];
  const Vec3 c = mesh_.points[cut.opposite[0]], d = mesh_.points[cut.opposite[1]];
  return std::min({norm(place - a), norm(place - b), norm(place - c), norm(place - d)}) < 0.05 * norm(a - b);
}

// Where an edge cuts a corner off or goes from sheet to sheet of a wall, the field leads to a foot that is too far, or
// beside one of the ends.
bool RefinableMesh::is_poor(const Cut& cut, const Foot& foot) const {
  return is_beside_end(cut, foot.point) ||
         foot.distance > 0.15 * norm(mesh_.points[cut.edge.a] - mesh_.points[cut.edge.b]);
}

bool RefinableMesh::is_beside_end(const Cut& cut, Vec3 place) const {
  const Vec3 a = mesh_.points[cut.edge.a], b = mesh_.points[cut.edge.b];
  return std::min(norm(place - a), norm(place - b)) < 0.3 * norm(a - b);
}

// What is before the mesh, where that is nearer; and where an edge goes through a wall, whose sides are always nearer
// than its end.
void RefinableMesh::look_ahead(std::span<const Cut> cuts, std::span<const PointNearSurface> middles, double tolerance,
                               std::span<Foot> feet) {
  std::vector<std::size_t> which;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    if (middles[i].planes != 0) continue;
    // Where a wall ends may be farther away than it is thick.
    const double length = std::max(norm(mesh_.points[cuts[i].edge.a] - mesh_.points[cuts[i].edge.b]),
                                   goes_through(cuts[i].edge) ? 2 * feet_.cell() : 0.0);
    which.push_back(i);
    rays.push_back({middles[i].point, length / norm(middles[i].ahead) * middles[i].ahead});
  }
  feet_.shoot(rays, tolerance / 20);
  for (std::size_t n = 0; n < rays.size(); ++n) {
    Foot& foot = feet[which[n]];
    const double ahead = norm(rays[n].from - middles[which[n]].point);
    const Cut& cut = cuts[which[n]];
    if (rays[n].hit && (ahead < foot.distance || is_beside_end(cut, foot.point) || goes_through(cut.edge)))
      foot = {rays[n].from, 0, {}};
  }
}

// The crease in which the sheets of both ends meet; or, on the way there, another sheet.
void RefinableMesh::look_for_creases(std::span<const Cut> cuts, std::span<const PointNearSurface> middles,
                                     double tolerance, std::span<const char> poor, std::span<Foot> feet) {
  std::vector<std::size_t> which;
  std::vector<Sheets> pairs;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    if (poor[i] == 0) continue;
    const auto [a, b] = std::pair(cuts[i].edge.a, cuts[i].edge.b);
    const double length = norm(mesh_.points[a] - mesh_.points[b]);
    pairs.push_back({.start = middles[i].point,
                     .at = {mesh_.points[a], mesh_.points[b]},
                     .gradient = {gradients_[a], gradients_[b]},
                     .planes = middles[i].planes,
                     .reach = std::min(6 * length, 1.5 * feet_.cell())});
    // In a wedge, the mesh's normal depends on how its sheets are cut; theirs lead to where they meet, which is far.
    const Vec3 both =
        within(middles[i].planes, gradients_[a] / norm(gradients_[a]) + gradients_[b] / norm(gradients_[b]));
    rays.push_back({middles[i].point, std::max(length, 1.5 * feet_.cell()) / norm(both) * both});
    which.push_back(i);
  }
  find_creases(pairs, near_surface * tolerance, feet_);
  feet_.shoot(rays, tolerance / 20);
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const Cut& cut = cuts[which[n]];
    Foot& foot = feet[which[n]];
    if (pairs[n].found && !is_taken(cut, pairs[n].crease))
      foot = {pairs[n].crease, 0, {}};
    else if (rays[n].hit && is_beside_end(cut, foot.point) && !is_taken(cut, rays[n].from))
      foot = {rays[n].from, 0, {}};
  }
}

void RefinableMesh::place(std::span<const Cut> cuts, std::span<const PointNearSurface> middles, double tolerance) {
  std::vector<Foot> feet;
  feet_.feet(middles, tolerance / (smooth_ ? 4 : 20), feet);
  if (!smooth_) {
    std::vector<char> poor;
    for (std::size_t i = 0; i < cuts.size(); ++i) poor.push_back(is_poor(cuts[i], feet[i]) ? 1 : 0);
    look_ahead(cuts, middles, tolerance, feet);
    look_for_creases(cuts, middles, tolerance, poor, feet);
  }
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    // A foot that is far away belongs to another part of the surface.
    const double length = norm(mesh_.points[cuts[i].edge.a] - mesh_.points[cuts[i].edge.b]);
    if (!(feet[i].distance < 0.7 * length)) feet[i].point = middles[i].point;
    // In a plane of the box, only a part of the gradient was asked for.
    if (middles[i].planes != 0 && norm(middles[i].gradient) > 0) feet[i].gradient = middles[i].gradient;
  }
  use_missed_creases(cuts, middles, feet);
  add_points(middles, feet, tolerance);
}

}  // namespace meso::implicit
