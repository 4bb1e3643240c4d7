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

// What the normals at both ends tell of an edge's distance is believed if it is below `surely` times the tolerance, or
// above 1 / `surely` times.
constexpr double surely = 0.4;

// What is asked of a point takes more memory than a triangle: so many points at a time.
constexpr std::size_t asked_at_once = 1 << 14;

bool tells(double distance, double tolerance) {
  return std::fabs(distance) <= surely * tolerance || std::fabs(distance) >= tolerance / surely;
}

}  // namespace

RefinableMesh::RefinableMesh(TriangleMesh mesh, const Box3& box, SurfaceFeet& feet, bool smooth)
    : mesh_(std::move(mesh)), box_(box), feet_(feet), smooth_(smooth), known_(mesh_.triangles.size()) {
  feet_.slopes(mesh_.points, gradients_, values_);
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

void RefinableMesh::measure_points(double tolerance) {
  std::vector<PointNearSurface> off;
  std::vector<std::size_t> which;
  std::vector<double> distances;
  const auto know = [&] {
    feet_.distances(off, tolerance, distances);
    for (std::size_t n = 0; n < which.size(); ++n) distances_[which[n]] = static_cast<float>(distances[n]);
    off.clear(), which.clear();
  };
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    if (!(distances_[i] > tolerance / 10)) continue;
    off.push_back({.point = mesh_.points[i],
                   .planes = planes_[i],
                   .slope = norm(gradients_[i]),
                   .ahead = within(planes_[i], gradients_[i]),
                   .most = 2 * feet_.cell()});
    which.push_back(i);
    if (off.size() == asked_at_once) know();
  }
  know();
}

unsigned RefinableMesh::plane_of_triangle(std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return planes_[t[0]] & planes_[t[1]] & planes_[t[2]];
}

PointNearSurface RefinableMesh::middle_of(std::uint32_t a, std::uint32_t b) const {
  const unsigned planes = planes_[a] & planes_[b];
  PointNearSurface middle{.point = (mesh_.points[a] + mesh_.points[b]) / 2, .planes = planes};
  middle.most =
      norm(mesh_.points[a] - mesh_.points[b]) / 2 + static_cast<double>(std::max(distances_[a], distances_[b]));
  if (turns_evenly(a, b))
    middle.gradient = (gradients_[a] + gradients_[b]) / 2;
  else if (planes == 0)  // slopes within a plane of the box may be any smaller
    middle.slope = std::min(norm(gradients_[a]), norm(gradients_[b]));
  return middle;
}

PointNearSurface RefinableMesh::middle_of(std::uint32_t triangle) const {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  PointNearSurface middle{.point = (mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3};
  for (const std::uint32_t p : mesh_.triangles[triangle])
    middle.most = std::min(middle.most, norm(mesh_.points[p] - middle.point) + static_cast<double>(distances_[p]));
  if (turns_evenly(a, b) && turns_evenly(b, c) && turns_evenly(c, a))
    middle.gradient = (gradients_[a] + gradients_[b] + gradients_[c]) / 3;
  else
    middle.slope = std::min({norm(gradients_[a]), norm(gradients_[b]), norm(gradients_[c])});
  return middle;
}

Vec3 RefinableMesh::normal_of(std::uint32_t triangle) const {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  return cross(mesh_.points[b] - mesh_.points[a], mesh_.points[c] - mesh_.points[a]);
}

// Normals at the ends that are up to 60 degrees apart tell what is between them.
bool RefinableMesh::turns_evenly(std::uint32_t a, std::uint32_t b) const {
  const unsigned planes = planes_[a] & planes_[b];
  const Vec3 na = within(planes, gradients_[a]), nb = within(planes, gradients_[b]);
  return smooth_ && dot(na, nb) > 0.5 * norm(na) * norm(nb);
}

// By one value each where the gradient is known; else along it, to the surface.
void RefinableMesh::ask(std::span<const PointNearSurface> points, double tolerance, std::vector<double>& distances) {
  std::vector<Vec3> simple;
  std::vector<PointNearSurface> others;
  for (const PointNearSurface& p : points)
    if (norm(p.gradient) > 0)
      simple.push_back(p.point);
    else
      others.push_back(p);
  std::vector<double> values, found;
  feet_.values(simple, values);
  feet_.distances(others, tolerance, found);
  distances.clear();
  auto value = values.begin(), distance = found.begin();
  for (const PointNearSurface& p : points)
    distances.push_back(norm(p.gradient) > 0 ? *value++ / norm(within(p.planes, p.gradient)) : *distance++);
  for (double& d : distances)
    if (!std::isfinite(d)) d = 0;
}

// The cubic that the normals at both ends tell has the heights (9 p - 3 q) / 64, (p - q) / 8 and (3 p - 9 q) / 64 over
// the quarters of its chord; p and q are its slopes times the chord's length.
RefinableMesh::Bend RefinableMesh::bend_along(std::uint32_t a, std::uint32_t b) const {
  const unsigned planes = planes_[a] & planes_[b];
  const Vec3 na = within(planes, gradients_[a]), nb = within(planes, gradients_[b]);
  const Vec3 along = mesh_.points[b] - mesh_.points[a];
  const double p = dot(na, along) / norm(na), q = dot(nb, along) / norm(nb);
  return {(p - q) / 8, 3.0 / 64 * std::fabs(p + q)};
}

void RefinableMesh::measure(double tolerance) {
  measure_edges(tolerance);
  measure_middles(tolerance);
}

void RefinableMesh::measure_edges(double tolerance) {
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::uint8_t side = 0; side < 3; ++side) {
      if (known_[t].edge[side] != unknown) continue;
      const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, side});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<PointNearSurface> asked;
  std::vector<std::pair<std::size_t, Bend>> first_of_asked;
  std::vector<double> distances;
  const auto know = [&](std::size_t e, double distance) {
    for (std::size_t i = e; i < e + 2; ++i)
      known_[edges[i].triangle].edge[edges[i].side] = static_cast<float>(distance);
  };
  const auto know_asked = [&] {
    ask(asked, tolerance, distances);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      auto& [edge, bend] = first_of_asked[i];
      bend.middle = std::clamp(distances[i], -asked[i].most, asked[i].most);
      know(edge, bend.farthest());
    }
    asked.clear(), first_of_asked.clear();
  };
  for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {  // the mesh is closed: every edge twice
    const unsigned p = plane_of_triangle(edges[e].triangle), q = plane_of_triangle(edges[e + 1].triangle);
    if (p != 0 && q != 0) {  // within the box's sides, or where two of them meet
      know(e, 0);
      continue;
    }
    Bend bend;
    if (turns_evenly(edges[e].a, edges[e].b)) {
      bend = bend_along(edges[e].a, edges[e].b);
      if (tells(bend.farthest(), tolerance)) {
        know(e, bend.farthest());
        continue;
      }
    }
    asked.push_back(middle_of(edges[e].a, edges[e].b));
    const Vec3 n0 = normal_of(edges[e].triangle), n1 = normal_of(edges[e + 1].triangle);
    asked.back().ahead = within(asked.back().planes, n0 / norm(n0) + n1 / norm(n1));
    first_of_asked.push_back({e, bend});
    if (asked.size() == asked_at_once) know_asked();
  }
  know_asked();
}

// Where an edge is to be halved, the middle will be another one. Of a triangle curved as a quadratic function is, the
// middle is 4/9 of the sum of the edges' distances away; beside an edge of the surface it may be any farther, but not
// than from the corners.
void RefinableMesh::measure_middles(double tolerance) {
  std::vector<PointNearSurface> asked;
  std::vector<std::uint32_t> triangles;
  std::vector<double> distances;
  const auto know_asked = [&] {
    ask(asked, tolerance, distances);
    for (std::size_t i = 0; i < distances.size(); ++i) known_[triangles[i]].middle = static_cast<float>(distances[i]);
    asked.clear(), triangles.clear();
  };
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto& edge = known_[t].edge;
    const auto size = [&](std::size_t side) { return std::fabs(edge[side]); };
    if (known_[t].middle != unknown || std::max({size(0), size(1), size(2)}) > tolerance) continue;
    const double told = 4.0 / 9 * (edge[0] + edge[1] + edge[2]);
    if (plane_of_triangle(t) != 0) {
      known_[t].middle = 0;
    } else if (smooth_ && tells(told, tolerance)) {
      known_[t].middle = static_cast<float>(told);
    } else {
      const PointNearSurface middle = middle_of(t);
      if (!smooth_ && middle.most <= tolerance) {
        known_[t].middle = static_cast<float>(middle.most);
        continue;
      }
      asked.push_back(middle);
      asked.back().ahead = normal_of(t);
      triangles.push_back(t);
      if (asked.size() == asked_at_once) know_asked();
    }
  }
  know_asked();
}

bool RefinableMesh::normals_were_right(double tolerance) {
  constexpr std::size_t least = 300, one_of = 200;
  if (!smooth_) return true;
  std::vector<PointNearSurface> asked;
  const std::size_t step = std::clamp<std::size_t>(known_.size() / least, 1, one_of);
  for (std::uint32_t t = 0; t < known_.size(); t += static_cast<std::uint32_t>(step)) {
    if (plane_of_triangle(t) != 0) continue;
    asked.push_back(middle_of(t));
    const std::size_t side = t / step % 3;
    asked.push_back(middle_of(mesh_.triangles[t][side], mesh_.triangles[t][(side + 1) % 3]));
  }
  for (PointNearSurface& p : asked) p.gradient = {};
  std::vector<Foot> found;
  feet_.feet(asked, tolerance / 20, found);
  if (std::all_of(found.begin(), found.end(), [&](const Foot& f) { return f.distance <= tolerance; })) return true;
  smooth_ = false;
  known_.assign(known_.size(), {});
  return false;
}

std::size_t RefinableMesh::refine(double tolerance) {
  std::vector<Cut> cuts;
  std::vector<std::uint32_t> bridges;
  const auto length = [&](std::uint32_t a, std::uint32_t b) { return norm(mesh_.points[a] - mesh_.points[b]); };
  const auto edge_of = [&](std::uint32_t t, std::size_t side) {
    const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
    return Edge{std::min(a, b), std::max(a, b), 0, 0};
  };
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto add = [&](std::size_t side) {
      const Edge e = edge_of(t, side);
      if (length(e.a, e.b) > tolerance) cuts.push_back({e, known_[t].edge[side], {}});
    };
    for (std::size_t side = 0; side < 3; ++side)
      if (std::fabs(known_[t].edge[side]) > tolerance) add(side);
    if (known_[t].middle == unknown || !(std::fabs(known_[t].middle) > tolerance)) continue;
    if (is_bridge(t)) {
      bridges.push_back(t);
      continue;
    }
    std::size_t longest = 0;
    const auto side_length = [&](std::size_t side) {
      const Edge e = edge_of(t, side);
      return length(e.a, e.b);
    };
    for (std::size_t side = 1; side < 3; ++side)
      if (side_length(side) > side_length(longest)) longest = side;
    add(longest);
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  if (cuts.empty() && bridges.empty()) return 0;
  std::vector<std::array<std::uint32_t, 3>> halved(known_.size(), {none, none, none});  // numbers of cuts
  std::vector<Vec3> normals(cuts.size());
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::size_t side = 0; side < 3; ++side) {
      const Cut wanted{edge_of(t, side), 0, {}};
      const auto found = std::lower_bound(cuts.begin(), cuts.end(), wanted);
      if (found == cuts.end() || !(*found == wanted)) continue;
      halved[t][side] = static_cast<std::uint32_t>(found - cuts.begin());
      const bool is_first = norm(normals[halved[t][side]]) == 0;
      found->opposite[is_first ? 0 : 1] = mesh_.triangles[t][(side + 2) % 3];
      normals[halved[t][side]] += normal_of(t);
    }
  const auto first = static_cast<std::uint32_t>(mesh_.points.size());
  std::vector<PointNearSurface> middles;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    middles.push_back(middle_of(cuts[i].edge.a, cuts[i].edge.b));
    PointNearSurface& middle = middles.back();
    middle.slope = 0;
    if (norm(middle.gradient) > 0)
      middle.value = static_cast<double>(cuts[i].distance) * norm(within(middle.planes, middle.gradient));
    middle.ahead = within(middle.planes, normals[i]);
    if (middles.size() < asked_at_once && i + 1 < cuts.size()) continue;
    place(std::span(cuts).subspan(i + 1 - middles.size(), middles.size()), middles, tolerance);
    middles.clear();
  }
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

float RefinableMesh::farthest(const Known& known) {
  float result = 0;
  for (const float d : {known.edge[0], known.edge[1], known.edge[2], known.middle})
    if (d != unknown) result = std::max(result, std::fabs(d));
  return result;
}

double RefinableMesh::distance() const {
  float largest = distances_.empty() ? 0 : *std::max_element(distances_.begin(), distances_.end());
  for (const Known& k : known_) largest = std::max(largest, farthest(k));
  return largest;
}

double RefinableMesh::triangles_for(double tolerance) const {
  double sum = 0;
  for (const Known& k : known_) sum += std::max(1.0, static_cast<double>(farthest(k)) / tolerance);
  return sum;
}

}  // namespace meso::implicit
