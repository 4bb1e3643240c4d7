// SPDX-License-Identifier: Apache-2.0
#include "refine_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace meso::implicit {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

}  // namespace

RefinableMesh::RefinableMesh(TriangleMesh mesh, const Box3& box, SurfaceFeet& feet, bool smooth,
                             std::span<const char> marked)
    : mesh_(std::move(mesh)),
      box_(box),
      feet_(feet),
      smooth_(smooth),
      known_(mesh_.triangles.size()),
      points_before_(mesh_.points.size()) {
  if (marked.empty())
    feet_.slopes(mesh_.points, gradients_, values_);
  else
    look_around(marked);
  for (const Vec3& p : mesh_.points) planes_.push_back(planes_of(box_, p));
  // Points that have triangles in the box's sides only are where they belong. The others are in a cell that the surface
  // crosses, or beside it: a flat field tells of more.
  const double most = 2 * feet_.cell();
  distances_.assign(mesh_.points.size(), 0);
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    if (plane_of_triangle(t) != 0) continue;
    for (const std::uint32_t p : mesh_.triangles[t]) {
      const double distance = std::fabs(values_[p]) / norm(within(planes_[p], gradients_[p]));
      distances_[p] = static_cast<float>(std::isfinite(distance) ? std::min(distance, most) : 0);
    }
  }
}

void RefinableMesh::look_around(std::span<const char> marked) {
  std::vector<char> is_near(mesh_.points.size(), 0);
  for (const auto& t : mesh_.triangles)
    if (std::ranges::any_of(t, [&](std::uint32_t p) { return marked[p] != 0; }))
      for (const std::uint32_t p : t) is_near[p] = 1;
  std::vector<std::size_t> which;
  std::vector<Vec3> places, gradients;
  std::vector<double> values;
  for (std::size_t p = 0; p < is_near.size(); ++p)
    if (is_near[p] != 0) which.push_back(p), places.push_back(mesh_.points[p]);
  feet_.slopes(places, gradients, values);
  gradients_.assign(mesh_.points.size(), {});
  values_.assign(mesh_.points.size(), 0);
  for (std::size_t i = 0; i < which.size(); ++i) gradients_[which[i]] = gradients[i], values_[which[i]] = values[i];
}

void RefinableMesh::move_vertices(double tolerance) {
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < distances_.size(); ++i)
    if (distances_[i] > tolerance / 10) which.push_back(i);
  for (std::size_t first = 0; first < which.size(); first += asked_at_once)
    move_onto_surface(std::span(which).subspan(first, std::min(asked_at_once, which.size() - first)), tolerance);
}

void RefinableMesh::move_onto_surface(std::span<const std::size_t> which, double tolerance) {
  std::vector<PointNearSurface> off;
  for (const std::size_t i : which)
    off.push_back({.point = mesh_.points[i], .planes = planes_[i], .gradient = gradients_[i], .value = values_[i]});
  std::vector<Foot> feet;
  feet_.feet(off, tolerance / (smooth_ ? 4 : 100), feet);
  std::vector<char> is_there(off.size(), 0), comes_there(off.size(), 1);
  if (!smooth_) {
    std::vector<Vec3> before, after, directions;
    for (std::size_t n = 0; n < off.size(); ++n) {
      before.push_back(off[n].point), after.push_back(feet[n].point);
      directions.push_back(within(off[n].planes, off[n].gradient));
    }
    feet_.check(before, directions, tolerance / 10, is_there);
    feet_.check(after, directions, tolerance / 10, comes_there);
  }
  for (std::size_t n = 0; n < which.size(); ++n) {
    // A foot that is far away belongs to another part of the surface.
    const bool near = feet[n].distance <= 2 * static_cast<double>(distances_[which[n]]);
    if (is_there[n] == 0 && comes_there[n] != 0 && near) mesh_.points[which[n]] = feet[n].point, is_there[n] = 1;
    if (is_there[n] != 0) distances_[which[n]] = 0;
  }
}

void RefinableMesh::sort_cuts(std::vector<Cut>& cuts) {
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
}

RefinableMesh::Edge RefinableMesh::edge_of(std::uint32_t triangle, std::size_t side) const {
  const std::uint32_t a = mesh_.triangles[triangle][side], b = mesh_.triangles[triangle][(side + 1) % 3];
  return {std::min(a, b), std::max(a, b), 0, 0};
}

// Edges to be halved: those that are too far, and the longest of a triangle that is; and triangles that halving does
// not mend.
void RefinableMesh::collect(double tolerance, std::vector<Cut>& cuts, std::vector<std::uint32_t>& bridges) const {
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto length = [&](std::size_t side) {
      const Edge e = edge_of(t, side);
      return norm(mesh_.points[e.a] - mesh_.points[e.b]);
    };
    const auto add = [&](std::size_t side) {
      if (length(side) > tolerance)
        cuts.push_back({edge_of(t, side), known_[t].edge[side], known_[t].farthest_at[side] / 8.0});
    };
    for (std::size_t side = 0; side < 3; ++side)
      if (std::fabs(known_[t].edge[side]) > tolerance) add(side);
    if (known_[t].middle == unknown || !(std::fabs(known_[t].middle) > tolerance)) continue;
    if (is_bridge(t)) {
      bridges.push_back(t);
      continue;
    }
    std::size_t longest = 0;
    for (std::size_t side = 1; side < 3; ++side)
      if (length(side) > length(longest)) longest = side;
    add(longest);
  }
  sort_cuts(cuts);
}

std::size_t RefinableMesh::refine(double tolerance) {
  std::vector<Cut> cuts;
  std::vector<std::uint32_t> bridges;
  missed_.clear();
  collect(tolerance, cuts, bridges);
  if (cuts.empty() && bridges.empty()) {
    measure_creases(tolerance);
    collect(tolerance, cuts, bridges);
    // Also edges that are short: the tip of a wedge may be far from them.
    for (const Missed& m : missed_) cuts.push_back({{m.edge.a, m.edge.b, 0, 0}, static_cast<float>(tolerance)});
    sort_cuts(cuts);
  }
  if (cuts.empty() && bridges.empty()) return 0;
  std::vector<std::array<std::uint32_t, 3>> halved(known_.size(), {none, none, none});  // numbers of cuts
  std::vector<Vec3> normals(cuts.size());
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::size_t side = 0; side < 3; ++side) {
      const Cut wanted{edge_of(t, side), 0};
      const auto found = std::lower_bound(cuts.begin(), cuts.end(), wanted);
      if (found == cuts.end() || !(*found == wanted)) continue;
      halved[t][side] = static_cast<std::uint32_t>(found - cuts.begin());
      const bool is_first = norm(normals[halved[t][side]]) == 0;
      found->opposite[is_first ? 0 : 1] = mesh_.triangles[t][(side + 2) % 3];
      normals[halved[t][side]] += normal_of(t);
    }
  const auto first = static_cast<std::uint32_t>(mesh_.points.size());
  halved_.resize(first, {none, none});
  for (const Cut& cut : cuts) halved_.push_back({cut.edge.a, cut.edge.b});
  // Grown by doubling, they would hold twice as much.
  mesh_.points.reserve(first + cuts.size());
  planes_.reserve(first + cuts.size());
  gradients_.reserve(first + cuts.size());
  distances_.reserve(first + cuts.size());
  std::vector<PointNearSurface> middles;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    middles.push_back(between(cuts[i].edge.a, cuts[i].edge.b, cuts[i].share));
    PointNearSurface& middle = middles.back();
    middle.slope = 0;
    if (norm(middle.gradient) > 0)
      middle.value = static_cast<double>(cuts[i].distance) * norm(within(middle.planes, middle.gradient));
    middle.ahead = within(middle.planes, normals[i]);
    if (middles.size() < asked_at_once && i + 1 < cuts.size()) continue;
    place(std::span(cuts).subspan(i + 1 - middles.size(), middles.size()), middles, tolerance);
    middles.clear();
  }
  std::size_t added = 0;
  for (const auto& middles_of : halved) added += 3 - static_cast<std::size_t>(std::ranges::count(middles_of, none));
  mesh_.triangles.reserve(mesh_.triangles.size() + added);
  known_.reserve(known_.size() + added);
  for (std::uint32_t t = 0; t < halved.size(); ++t) {
    for (std::uint32_t& middle : halved[t])
      if (middle != none) middle += first;
    split(t, halved[t]);
  }
  std::erase_if(bridges, [&](std::uint32_t t) { return halved[t] != std::array{none, none, none}; });
  divide(bridges, tolerance);
  return cuts.size() + bridges.size();
}

// Cut at the middles there are: into two, three (by the shorter diagonal) or four.
void RefinableMesh::split(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles) {
  const auto count = std::count_if(middles.begin(), middles.end(), [](std::uint32_t m) { return m != none; });
  if (count == 0) return;
  const std::array<std::uint32_t, 3> c = mesh_.triangles[triangle];
  const Known known = known_[triangle];
  bool replaced = false;
  // Distances of edges that stay are known.
  const auto put = [&](std::array<std::uint32_t, 3> t, std::array<float, 3> edge) {
    Known k;
    k.edge = edge;
    if (!replaced) {
      mesh_.triangles[triangle] = t;
      known_[triangle] = k;
      replaced = true;
    } else {
      mesh_.triangles.push_back(t);
      known_.push_back(k);
    }
  };
  std::size_t r = 0;  // turned so that the odd one out comes first
  if (count == 1)
    while (middles[r] == none) ++r;
  if (count == 2)
    while (middles[r] != none) ++r;
  const auto at = [&](std::size_t i) { return c[(r + i) % 3]; };
  const auto m = [&](std::size_t i) { return middles[(r + i) % 3]; };
  const auto e = [&](std::size_t i) { return known.edge[(r + i) % 3]; };
  if (count == 3) {
    for (std::size_t i = 0; i < 3; ++i) put({at(i), m(i), m((i + 2) % 3)}, {unknown, unknown, unknown});
    put({m(0), m(1), m(2)}, {unknown, unknown, unknown});
  } else if (count == 1) {
    put({at(0), m(0), at(2)}, {unknown, unknown, e(2)});
    put({m(0), at(1), at(2)}, {unknown, e(1), unknown});
  } else {
    // Sides 1 and 2 are halved: the corner between them, and a quadrangle 0, 1, m(1), m(2).
    put({at(2), m(2), m(1)}, {unknown, unknown, unknown});
    const auto distance = [&](std::uint32_t p, std::uint32_t q) { return norm(mesh_.points[p] - mesh_.points[q]); };
    if (distance(at(0), m(1)) < distance(at(1), m(2))) {
      put({at(0), at(1), m(1)}, {e(0), unknown, unknown});
      put({at(0), m(1), m(2)}, {unknown, unknown, unknown});
    } else {
      put({at(0), at(1), m(2)}, {e(0), unknown, unknown});
      put({at(1), m(1), m(2)}, {unknown, unknown, unknown});
    }
  }
}

}  // namespace meso::implicit
