// SPDX-License-Identifier: Apache-2.0
// The other way, from the surface to its mesh: that is farther where a mesh cuts off a crease. What it leaves out of a
// thin wedge is near to the wedge's sides, and its edge is not; of a curved crease, a chord is nearer to its sheets
// than to itself.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "crease_finder.hpp"
#include "meso/mesh/closest_point.hpp"
#include "refine_mesh.hpp"

namespace meso::implicit {
namespace {

Triangle triangle_of(const TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.points[a], mesh.points[b], mesh.points[c]};
}

/// From each place to the mesh, as far as it is less than `most`. Places are few: each triangle looks for those beside
/// it.
std::vector<double> distances_to(const TriangleMesh& mesh, std::span<const Vec3> places, double most) {
  std::vector<std::size_t> by_x(places.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t i, std::size_t j) { return places[i].x < places[j].x; });
  std::vector<double> result(places.size(), most);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = triangle_of(mesh, t);
    Box3 box;
    for (const Vec3& corner : triangle) box.extend(corner);
    auto next = std::lower_bound(by_x.begin(), by_x.end(), box.min.x - most,
                                 [&](std::size_t i, double x) { return places[i].x < x; });
    for (; next != by_x.end() && places[*next].x <= box.max.x + most; ++next) {
      const Vec3 p = places[*next];
      double& nearest = result[*next];
      if (p.y < box.min.y - nearest || p.y > box.max.y + nearest || p.z < box.min.z - nearest ||
          p.z > box.max.z + nearest)
        continue;
      nearest = std::min(nearest, norm(to_closest_point(triangle, p)));
    }
  }
  return result;
}

}  // namespace

// An edge between two sheets, or between triangles of two sheets: the crease in which they meet is looked for where the
// mesh is some way off. Nearer, even a wedge of 20 degrees ends within the tolerance.
std::vector<RefinableMesh::Missed> RefinableMesh::possibly_missed(double tolerance) const {
  constexpr double off = 0.15, turned = 0.9;
  const auto are_sheets = [&](Vec3 p, Vec3 q) { return dot(p, q) < turned * norm(p) * norm(q); };
  std::vector<char> beside(mesh_.points.size(), 0);  // two sheets meet in one of the point's triangles
  for (const auto& [a, b, c] : mesh_.triangles)
    if (are_sheets(gradients_[a], gradients_[b]) || are_sheets(gradients_[b], gradients_[c]) ||
        are_sheets(gradients_[c], gradients_[a]))
      beside[a] = beside[b] = beside[c] = 1;
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::uint8_t side = 0; side < 3; ++side) {
      const float known = known_[t].edge[side];
      if (known == unknown || !(std::fabs(known) > off * tolerance)) continue;
      if (beside[mesh_.triangles[t][side]] == 0 || beside[mesh_.triangles[t][(side + 1U) % 3]] == 0) continue;
      const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, side});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<Missed> missed;
  for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {
    const Edge &one = edges[e], &other = edges[e + 1];
    const unsigned planes = planes_[one.a] & planes_[one.b];
    const std::uint32_t c = mesh_.triangles[one.triangle][(one.side + 2U) % 3],
                        d = mesh_.triangles[other.triangle][(other.side + 2U) % 3];
    const auto are_two_sheets = [&](std::uint32_t p, std::uint32_t q) {
      return are_sheets(within(planes, gradients_[p]), within(planes, gradients_[q]));
    };
    for (const auto& [p, q] : {std::pair{one.a, one.b}, std::pair{c, d}})
      if (are_two_sheets(p, q) && (p == one.a || planes == 0))
        missed.push_back({.edge = one, .other = other, .sheets = {p, q}});
  }
  return missed;
}

void RefinableMesh::measure_creases(double tolerance) {
  missed_.clear();
  if (smooth_) return;
  std::vector<Missed> all = possibly_missed(tolerance);
  if (all.empty()) return;
  std::vector<Sheets> sheets;
  std::vector<Vec3> places;
  double most = tolerance;
  for (std::size_t first = 0; first < all.size(); first += asked_at_once) {
    const auto some = std::span(all).subspan(first, std::min(asked_at_once, all.size() - first));
    sheets.clear();
    for (const Missed& m : some) {
      const double length = norm(mesh_.points[m.edge.a] - mesh_.points[m.edge.b]);
      sheets.push_back({.start = (mesh_.points[m.edge.a] + mesh_.points[m.edge.b]) / 2,
                        .at = {mesh_.points[m.sheets[0]], mesh_.points[m.sheets[1]]},
                        .gradient = {gradients_[m.sheets[0]], gradients_[m.sheets[1]]},
                        .planes = planes_[m.edge.a] & planes_[m.edge.b],
                        .reach = std::min(6 * length, 1.5 * feet_.cell())});
    }
    find_creases(sheets, near_surface * tolerance, feet_);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (!sheets[i].found) continue;
      // No farther than its own triangles.
      double distance = HUGE_VAL;
      for (const Edge& edge : {some[i].edge, some[i].other})
        distance = std::min(distance, norm(to_closest_point(triangle_of(mesh_, edge.triangle), sheets[i].crease)));
      if (!(distance > tolerance)) continue;
      some[i].place = sheets[i].crease;
      places.push_back(sheets[i].crease);
      most = std::max(most, distance);
      missed_.push_back(some[i]);
    }
  }
  const std::vector<double> distances = distances_to(mesh_, places, most);
  std::size_t next = 0;
  std::erase_if(missed_, [&](const Missed& m) {
    const double distance = distances[next++];
    if (!(distance > tolerance)) return true;
    for (float* known : {&known_[m.edge.triangle].edge[m.edge.side], &known_[m.other.triangle].edge[m.other.side]})
      *known = std::max(*known, static_cast<float>(distance));
    return false;
  });
  std::sort(missed_.begin(), missed_.end(), [](const Missed& m, const Missed& n) { return m.edge < n.edge; });
}

// Where an edge is halved that leaves out a crease, its vertex goes there.
void RefinableMesh::use_missed_creases(std::span<const Cut> cuts, std::span<const PointNearSurface> middles,
                                       std::span<Foot> feet) const {
  const auto before = [](const Missed& m, const Cut& cut) {
    return std::pair(m.edge.a, m.edge.b) < std::pair(cut.edge.a, cut.edge.b);
  };
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const auto found = std::lower_bound(missed_.begin(), missed_.end(), cuts[i], before);
    if (found == missed_.end() || found->edge.a != cuts[i].edge.a || found->edge.b != cuts[i].edge.b) continue;
    feet[i] = {found->place, norm(found->place - middles[i].point), {}};
  }
}

}  // namespace meso::implicit
