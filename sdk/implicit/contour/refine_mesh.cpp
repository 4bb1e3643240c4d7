// SPDX-License-Identifier: Apache-2.0
#include "refine_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace meso::implicit {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

}  // namespace

RefinableMesh::RefinableMesh(TriangleMesh mesh, const Box3& box, SurfaceFeet& feet)
    : mesh_(std::move(mesh)), box_(box), feet_(feet), known_(mesh_.triangles.size()) {
  std::vector<Vec3> slopes;
  std::vector<double> values;
  feet_.slopes(mesh_.points, slopes, values);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    slopes_.push_back(norm(slopes[i]));
    planes_.push_back(planes_of(box_, mesh_.points[i]));
    const double distance = planes_.back() != 0 ? 0 : std::fabs(values[i]) / slopes_.back();
    distances_.push_back(static_cast<float>(std::isfinite(distance) ? distance : 0));
  }
}

void RefinableMesh::move_vertices(double tolerance) {
  std::vector<PointNearSurface> off;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    if (!(distances_[i] > tolerance / 10)) continue;
    off.push_back({.point = mesh_.points[i]});
    which.push_back(i);
  }
  std::vector<Foot> feet;
  feet_.feet(off, tolerance / 100, feet);
  for (std::size_t n = 0; n < which.size(); ++n) {
    if (feet[n].distance > 2 * static_cast<double>(distances_[which[n]])) continue;  // of another part of the surface
    mesh_.points[which[n]] = feet[n].point;
    distances_[which[n]] = 0;
  }
}

unsigned RefinableMesh::plane_of_triangle(std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return planes_[t[0]] & planes_[t[1]] & planes_[t[2]];
}

PointNearSurface RefinableMesh::middle_of(std::uint32_t a, std::uint32_t b) const {
  const unsigned planes = planes_[a] & planes_[b];
  // Slopes within a plane of the box may be any smaller.
  return {(mesh_.points[a] + mesh_.points[b]) / 2, planes, planes != 0 ? 0 : std::min(slopes_[a], slopes_[b])};
}

void RefinableMesh::measure(double tolerance) {
  measure_edges(tolerance);
  measure_middles(tolerance);
}

void RefinableMesh::measure_edges(double tolerance) {
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::uint8_t side = 0; side < 3; ++side) {
      if (known_[t].edge[side] >= 0) continue;
      const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, side});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<PointNearSurface> asked;
  std::vector<std::size_t> first_of_asked;
  for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {  // the mesh is closed: every edge twice
    const unsigned p = plane_of_triangle(edges[e].triangle), q = plane_of_triangle(edges[e + 1].triangle);
    if (p != 0 && q != 0) {  // within the box's sides, or where two of them meet
      known_[edges[e].triangle].edge[edges[e].side] = known_[edges[e + 1].triangle].edge[edges[e + 1].side] = 0;
      continue;
    }
    asked.push_back(middle_of(edges[e].a, edges[e].b));
    first_of_asked.push_back(e);
  }
  std::vector<double> distances;
  feet_.distances(asked, tolerance, distances);
  for (std::size_t i = 0; i < distances.size(); ++i)
    for (std::size_t e = first_of_asked[i]; e < first_of_asked[i] + 2; ++e)
      known_[edges[e].triangle].edge[edges[e].side] = static_cast<float>(distances[i]);
}

// Where an edge is to be halved, the middle will be another one. Of a curved triangle, the middle is 4/9 of the sum of
// the edges' distances away: less than half of the tolerance where these are less than a third.
void RefinableMesh::measure_middles(double tolerance) {
  std::vector<PointNearSurface> asked;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto& edge = known_[t].edge;
    if (known_[t].middle >= 0 || std::max({edge[0], edge[1], edge[2]}) > tolerance) continue;
    if (plane_of_triangle(t) != 0 || edge[0] + edge[1] + edge[2] < tolerance) {
      known_[t].middle = 0;
      continue;
    }
    const auto& [a, b, c] = mesh_.triangles[t];
    asked.push_back(
        {(mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3, 0, std::min({slopes_[a], slopes_[b], slopes_[c]})});
    triangles.push_back(t);
  }
  std::vector<double> distances;
  feet_.distances(asked, tolerance, distances);
  for (std::size_t i = 0; i < distances.size(); ++i) known_[triangles[i]].middle = static_cast<float>(distances[i]);
}

std::size_t RefinableMesh::refine(double tolerance) {
  std::vector<Edge> edges;
  const auto length = [&](std::uint32_t a, std::uint32_t b) { return norm(mesh_.points[a] - mesh_.points[b]); };
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto& corners = mesh_.triangles[t];
    const auto add = [&](std::size_t side) {
      const std::uint32_t a = corners[side], b = corners[(side + 1) % 3];
      if (length(a, b) > tolerance) edges.push_back({std::min(a, b), std::max(a, b), 0, 0});
    };
    for (std::size_t side = 0; side < 3; ++side)
      if (known_[t].edge[side] > tolerance) add(side);
    if (!(known_[t].middle > tolerance)) continue;
    std::size_t longest = 0;
    for (std::size_t side = 1; side < 3; ++side)
      if (length(corners[side], corners[(side + 1) % 3]) > length(corners[longest], corners[(longest + 1) % 3]))
        longest = side;
    add(longest);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.empty()) return 0;
  std::vector<PointNearSurface> middles;
  for (const Edge& e : edges) {
    middles.push_back(middle_of(e.a, e.b));
    middles.back().slope = 0;
  }
  std::vector<Foot> feet;
  feet_.feet(middles, tolerance / 20, feet);
  const auto first = static_cast<std::uint32_t>(mesh_.points.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    // A foot that is far away belongs to another part of the surface.
    const bool near = feet[i].distance < 0.5 * length(edges[i].a, edges[i].b);
    mesh_.points.push_back(near ? feet[i].point : middles[i].point);
    planes_.push_back(planes_of(box_, mesh_.points.back()));
    slopes_.push_back(feet[i].slope);
    distances_.push_back(0);
  }
  const auto count = static_cast<std::uint32_t>(known_.size());
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<std::uint32_t, 3> halved{none, none, none};
    const auto corners = mesh_.triangles[t];
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t a = corners[side], b = corners[(side + 1) % 3];
      const Edge wanted{std::min(a, b), std::max(a, b), 0, 0};
      const auto found = std::lower_bound(edges.begin(), edges.end(), wanted);
      if (found != edges.end() && *found == wanted)
        halved[side] = first + static_cast<std::uint32_t>(found - edges.begin());
    }
    split(t, halved);
  }
  return edges.size();
}

// Cut at the middles there are: into two, three (by the shorter diagonal) or four.
void RefinableMesh::split(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles) {
  const auto count = std::count_if(middles.begin(), middles.end(), [](std::uint32_t m) { return m != none; });
  if (count == 0) return;
  const std::array<std::uint32_t, 3> c = mesh_.triangles[triangle];
  const Known known = known_[triangle];
  bool replaced = false;
  // Distances of edges that stay are known; -1 elsewhere.
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
    for (std::size_t i = 0; i < 3; ++i) put({at(i), m(i), m((i + 2) % 3)}, {-1, -1, -1});
    put({m(0), m(1), m(2)}, {-1, -1, -1});
  } else if (count == 1) {
    put({at(0), m(0), at(2)}, {-1, -1, e(2)});
    put({m(0), at(1), at(2)}, {-1, e(1), -1});
  } else {
    // Sides 1 and 2 are halved: the corner between them, and a quadrangle 0, 1, m(1), m(2).
    put({at(2), m(2), m(1)}, {-1, -1, -1});
    const auto distance = [&](std::uint32_t p, std::uint32_t q) { return norm(mesh_.points[p] - mesh_.points[q]); };
    if (distance(at(0), m(1)) < distance(at(1), m(2))) {
      put({at(0), at(1), m(1)}, {e(0), -1, -1});
      put({at(0), m(1), m(2)}, {-1, -1, -1});
    } else {
      put({at(0), at(1), m(2)}, {e(0), -1, -1});
      put({at(1), m(1), m(2)}, {-1, -1, -1});
    }
  }
}

double RefinableMesh::distance() const {
  float largest = distances_.empty() ? 0 : *std::max_element(distances_.begin(), distances_.end());
  for (const Known& k : known_) largest = std::max({largest, k.edge[0], k.edge[1], k.edge[2], k.middle});
  return largest;
}

double RefinableMesh::triangles_for(double tolerance) const {
  double sum = 0;
  for (const Known& k : known_)
    sum += std::max(1.0, static_cast<double>(std::max({k.edge[0], k.edge[1], k.edge[2], k.middle})) / tolerance);
  return sum;
}

double RefinableMesh::share_beyond(double distance) const {
  std::size_t beyond = 0;
  for (const Known& k : known_)
    for (const float edge : k.edge) beyond += edge > distance ? 1 : 0;
  return known_.empty() ? 0 : static_cast<double>(beyond) / static_cast<double>(3 * known_.size());
}

}  // namespace meso::implicit
