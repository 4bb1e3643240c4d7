// SPDX-License-Identifier: Apache-2.0
// Vertices that have come to the same place.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mesh_links.hpp"
#include "meso/base/triangle_stream.hpp"
#include "refine_mesh.hpp"

namespace meso::implicit {
namespace {

constexpr std::uint32_t gone = std::numeric_limits<std::uint32_t>::max();

/// Its height over its longest side.
double width_of(const Triangle& t) {
  const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  return norm(cross(t[1] - t[0], t[2] - t[0])) / (longest * longest);
}

}  // namespace

// Pairs of points that are no farther apart than that, of those from `first` on.
std::vector<RefinableMesh::Ends> RefinableMesh::coincident(std::size_t first, double distance) const {
  // Along a direction that no usual plane is square to: of a plane's points all would be alike.
  constexpr Vec3 direction{0.48, 0.60, 0.64};
  std::vector<std::pair<double, std::uint32_t>> along;
  for (std::size_t p = first; p < mesh_.points.size(); ++p)
    along.emplace_back(dot(direction, mesh_.points[p]), static_cast<std::uint32_t>(p));
  std::sort(along.begin(), along.end());
  std::vector<Ends> pairs;
  for (std::size_t i = 0; i < along.size(); ++i)
    for (std::size_t j = i + 1; j < along.size() && along[j].first - along[i].first <= distance; ++j) {
      const auto [a, b] = std::minmax(along[i].second, along[j].second);
      if (norm(mesh_.points[a] - mesh_.points[b]) <= distance) pairs.push_back({a, b});
    }
  return pairs;
}

// Several edges lead to one corner. What is between their vertices there is triangles of no area, or two triangles back
// to back; neither is mended by halving.
void RefinableMesh::merge(double tolerance) {
  constexpr double nothing = 0.02, apart = 0.05;  // of the tolerance
  constexpr double narrow = 1e-4;
  if (smooth_) return;
  std::vector<Ends> pairs = coincident(points_before_, nothing * tolerance);
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
    for (std::size_t side = 0; side < 3; ++side) {
      const Edge edge = edge_of(t, side);
      if (norm(mesh_.points[edge.a] - mesh_.points[edge.b]) <= nothing * tolerance) pairs.push_back({edge.a, edge.b});
    }
  if (pairs.empty()) return;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  MeshLinks links(mesh_);
  std::vector<std::uint32_t> near;
  std::vector<char> is_new(mesh_.points.size(), 0);
  for (const auto& [a, b] : pairs) {
    if (!links.has_point(a) || !links.has_point(b)) continue;
    // A point on planes of the box moves onto one that is on them, too.
    const bool to_a = (planes_[b] & ~planes_[a]) == 0;
    if (!to_a && (planes_[a] & ~planes_[b]) != 0) continue;
    const std::uint32_t from = to_a ? b : a, onto = to_a ? a : b;
    if (norm(mesh_.points[from] - mesh_.points[onto]) > nothing * tolerance) continue;
    bool stays_wide = true;  // one without area may have to go with the next of several such points
    links.visit_triangles(from, [&](std::uint32_t t) {
      if (links.is_corner(t, onto)) return;
      Triangle before, after;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t p = mesh_.triangles[t][i];
        before[i] = mesh_.points[p];
        after[i] = mesh_.points[p == from ? onto : p];
      }
      stays_wide = stays_wide && (width_of(after) > narrow || !(width_of(before) > narrow));
    });
    if (!stays_wide) continue;
    if (links.stays_manifold(from, onto) || links.unfold(from, onto)) {
      links.collapse(from, onto);
      distances_[onto] = std::max(distances_[onto], distances_[from]);
      distances_[from] = 0;
      is_new[onto] = 1;
    } else {
      // Where they cannot be one, they must be two in a file of floats, too.
      links.neighbours(from, near);
      Vec3 sum;
      for (const std::uint32_t p : near) sum += mesh_.points[p];
      const Vec3 way = within(planes_[from], sum / static_cast<double>(near.size()) - mesh_.points[from]);
      if (!(norm(way) > 0)) continue;
      mesh_.points[from] += apart * tolerance / norm(way) * way;
      distances_[from] += static_cast<float>(apart * tolerance);
      is_new[from] = 1;
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (mesh_.triangles[t][0] == gone) continue;
    mesh_.triangles[kept] = mesh_.triangles[t];
    known_[kept] = known_[t];
    const auto& c = mesh_.triangles[kept];
    for (std::size_t side = 0; side < 3; ++side)
      if (is_new[c[side]] != 0 || is_new[c[(side + 1) % 3]] != 0)
        known_[kept].edge[side] = known_[kept].middle = unknown;
    ++kept;
  }
  mesh_.triangles.resize(kept);
  known_.resize(kept);
}

void drop_unused_points(TriangleMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.points.size(), gone);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t p : t) number[p] = 0;
  std::uint32_t kept = 0;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] == gone) continue;
    mesh.points[kept] = mesh.points[p];
    number[p] = kept++;
  }
  mesh.points.resize(kept);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& p : t) p = number[p];
}

TriangleMesh RefinableMesh::take() {
  drop_unused_points(mesh_);
  return std::move(mesh_);
}

}  // namespace meso::implicit
