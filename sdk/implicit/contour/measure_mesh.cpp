// SPDX-License-Identifier: Apache-2.0
// How far a mesh is from the surface: where that is asked, and where it is known without.

#include <algorithm>
#include <array>
#include <cmath>

#include "refine_mesh.hpp"

namespace meso::implicit {
namespace {

// What the normals at both ends tell of an edge's distance is believed if it is below `surely` times the tolerance, or
// above 1 / `surely` times.
constexpr double surely = 0.4;

bool tells(double distance, double tolerance) {
  return std::fabs(distance) <= surely * tolerance || std::fabs(distance) >= tolerance / surely;
}

/// Points between those that are measured may be farther by this factor.
constexpr double farther_between = 1.04;

/// The largest of heights over equal steps, and of where lines through the two before and the two behind a step meet
/// within it.
double peak_of(std::span<const double> height) {
  double peak = *std::max_element(height.begin(), height.end());
  for (std::size_t i = 1; i + 2 < height.size(); ++i) {
    const double rise = height[i] - height[i - 1], fall = height[i + 1] - height[i + 2];
    if (!(rise > 0 && fall > 0)) continue;
    const double share = (height[i + 1] + fall - height[i]) / (rise + fall);
    if (share > 0 && share < 1) peak = std::max(peak, height[i] + share * rise);
  }
  return peak;
}

}  // namespace

void RefinableMesh::take_as_known(std::span<const char> marked) {
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const auto& corners = mesh_.triangles[t];
    for (std::size_t side = 0; side < 3; ++side)
      if (marked[corners[side]] == 0 || marked[corners[(side + 1) % 3]] == 0) known_[t].edge[side] = 0;
    if (std::ranges::any_of(corners, [&](std::uint32_t p) { return marked[p] == 0; })) known_[t].middle = 0;
  }
  for (std::size_t p = 0; p < distances_.size(); ++p)
    if (marked[p] == 0) distances_[p] = 0;
}

void RefinableMesh::take_as_far(std::span<const char> marked, double tolerance) {
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::size_t side = 0; side < 3; ++side) {
      const Edge edge = edge_of(t, side);
      if (marked[edge.a] != 0 && marked[edge.b] != 0 && norm(mesh_.points[edge.a] - mesh_.points[edge.b]) > tolerance)
        known_[t].edge[side] = static_cast<float>(2 * tolerance);
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

PointNearSurface RefinableMesh::between(std::uint32_t a, std::uint32_t b, double share_of_b) const {
  const unsigned planes = planes_[a] & planes_[b];
  const double share_of_a = 1 - share_of_b, length = norm(mesh_.points[a] - mesh_.points[b]);
  PointNearSurface result{.point = share_of_a * mesh_.points[a] + share_of_b * mesh_.points[b], .planes = planes};
  result.most = share_of_a == share_of_b ? length / 2 + static_cast<double>(std::max(distances_[a], distances_[b]))
                                         : std::min(share_of_b * length + static_cast<double>(distances_[a]),
                                                    share_of_a * length + static_cast<double>(distances_[b]));
  if (turns_evenly(a, b))
    result.gradient = share_of_a * gradients_[a] + share_of_b * gradients_[b];
  else if (planes == 0)  // slopes within a plane of the box may be any smaller
    result.slope = std::min(norm(gradients_[a]), norm(gradients_[b]));
  return result;
}

PointNearSurface RefinableMesh::between(std::uint32_t triangle, Vec3 shares) const {
  const auto& corners = mesh_.triangles[triangle];
  const auto& [a, b, c] = corners;
  PointNearSurface result;
  for (std::size_t i = 0; i < 3; ++i) result.point += shares[i] * mesh_.points[corners[i]];
  for (const std::uint32_t p : corners)
    result.most = std::min(result.most, norm(mesh_.points[p] - result.point) + static_cast<double>(distances_[p]));
  if (turns_evenly(a, b) && turns_evenly(b, c) && turns_evenly(c, a))
    for (std::size_t i = 0; i < 3; ++i) result.gradient += shares[i] * gradients_[corners[i]];
  else
    result.slope = std::min({norm(gradients_[a]), norm(gradients_[b]), norm(gradients_[c])});
  return result;
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
  std::size_t open = 0;  // no more is taken than that: there may be millions
  for (const Known& known : known_) open += static_cast<std::size_t>(std::ranges::count(known.edge, unknown));
  edges.reserve(open);
  for (std::uint32_t t = 0; t < known_.size(); ++t)
    for (std::uint8_t side = 0; side < 3; ++side) {
      if (known_[t].edge[side] != unknown) continue;
      const std::uint32_t a = mesh_.triangles[t][side], b = mesh_.triangles[t][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, side});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<PointNearSurface> asked;
  std::vector<std::pair<std::size_t, Bend>> first_of_asked;
  std::vector<std::uint32_t> along;  // the first of each pair of edges
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
    if (!turns_evenly(edges[e].a, edges[e].b)) along.push_back(static_cast<std::uint32_t>(e));
  }
  know_asked();
  measure_along(edges, along, tolerance);
}

// How far the tangent plane at the one end is from the other end, and the other way, in all: a surface that turns to
// one side between them is no farther from the edge than half of that.
double RefinableMesh::tangents_leave(std::uint32_t a, std::uint32_t b) const {
  const unsigned planes = planes_[a] & planes_[b];
  const Vec3 along = mesh_.points[b] - mesh_.points[a];
  double most = 0;
  for (const std::uint32_t end : {a, b}) {
    const Vec3 normal = within(planes, gradients_[end]);
    const double height = std::fabs(dot(normal, along)) / norm(normal);
    most = std::max(most, std::isfinite(height) ? height : norm(along));
  }
  return most;
}

// An edge that leaves one sheet of the surface for another is farthest at the crease between them, wherever that is:
// two lines that rise to it from both sides tell how far. Where an edge is far, or where its tangents at its ends leave
// little room, nothing is asked.
void RefinableMesh::measure_along(std::span<const Edge> edges, std::span<const std::uint32_t> pairs, double tolerance) {
  constexpr std::size_t at_once = asked_at_once / 4;
  constexpr double near = 0.5;
  struct Profile {
    Edge edge;
    Vec3 ahead;
    std::array<double, 9> height{};
  };
  std::vector<Profile> profiles;
  std::vector<PointNearSurface> asked;
  std::vector<double> distances;
  const auto distance_of = [&](std::size_t e) -> float& { return known_[edges[e].triangle].edge[edges[e].side]; };
  const auto ask_at = [&](std::span<Profile> some, std::span<const std::size_t> eighths) {
    asked.clear();
    for (const Profile& p : some)
      for (const std::size_t n : eighths) {
        asked.push_back(between(p.edge.a, p.edge.b, static_cast<double>(n) / 8));
        asked.back().ahead = within(asked.back().planes, p.ahead);
      }
    ask(asked, tolerance, distances);
    for (std::size_t i = 0; i < asked.size(); ++i)
      some[i / eighths.size()].height[eighths[i % eighths.size()]] = std::clamp(distances[i], 0.0, asked[i].most);
  };
  for (std::size_t pair = 0; pair < pairs.size();) {
    profiles.clear();
    std::vector<std::size_t> which;
    for (; pair < pairs.size() && profiles.size() < at_once; ++pair) {
      const std::size_t e = pairs[pair];
      const double told = static_cast<double>(distance_of(e)), left = tangents_leave(edges[e].a, edges[e].b) / 2;
      if (told > tolerance) continue;
      if (left <= near * tolerance) {
        for (const std::size_t i : {e, e + 1})
          distance_of(i) = static_cast<float>(std::max(told, std::min(left, 2 * told)));
        continue;
      }
      const Vec3 n0 = normal_of(edges[e].triangle), n1 = normal_of(edges[e + 1].triangle);
      profiles.push_back({edges[e], n0 / norm(n0) + n1 / norm(n1)});
      profiles.back().height[4] = told;
      profiles.back().height[0] = static_cast<double>(distances_[edges[e].a]);
      profiles.back().height[8] = static_cast<double>(distances_[edges[e].b]);
      which.push_back(e);
    }
    const auto know = [&](std::size_t first, const Profile& profile, double distance) {
      const auto farthest = std::max_element(profile.height.begin() + 1, profile.height.end() - 1);
      for (const std::size_t n : {first, first + 1}) {
        Known& known = known_[edges[n].triangle];
        known.edge[edges[n].side] = static_cast<float>(distance);
        known.farthest_at[edges[n].side] = static_cast<std::uint8_t>(farthest - profile.height.begin());
      }
    };
    ask_at(profiles, std::array<std::size_t, 2>{2, 6});
    std::vector<Profile> close;
    std::vector<std::size_t> which_close;
    for (std::size_t i = 0; i < profiles.size(); ++i) {
      const auto& h = profiles[i].height;
      const double farthest = std::max({h[2], h[4], h[6]});
      know(which[i], profiles[i], farthest);
      if (farthest < near * tolerance || farthest > tolerance) continue;
      close.push_back(profiles[i]);
      which_close.push_back(which[i]);
    }
    ask_at(close, std::array<std::size_t, 4>{1, 3, 5, 7});
    for (std::size_t i = 0; i < close.size(); ++i)
      know(which_close[i], close[i], farther_between * peak_of(close[i].height));
  }
}

// Where an edge is to be halved, the middle will be another one. Of a triangle curved as a quadratic function is, the
// middle is 4/9 of the sum of the edges' distances away; beside an edge of the surface it may be any farther, but not
// than from the corners.
void RefinableMesh::measure_middles(double tolerance) {
  std::vector<PointNearSurface> asked;
  std::vector<std::uint32_t> triangles, within;
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
      if (norm(middle.gradient) == 0) within.push_back(t);
      if (asked.size() == asked_at_once) know_asked();
    }
  }
  know_asked();
  measure_within(within, tolerance);
}

// Over a corner or a crease that is not in its middle, a triangle is farther there than in its middle.
void RefinableMesh::measure_within(std::span<const std::uint32_t> triangles, double tolerance) {
  constexpr double near = 0.5;
  std::vector<PointNearSurface> asked;
  std::vector<double> distances;
  std::vector<std::uint32_t> which;
  const auto ask_at = [&](std::span<const Vec3> places, double least) {
    const auto know_asked = [&] {
      ask(asked, tolerance, distances);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        float& middle = known_[which[i]].middle;
        middle = std::max(middle, static_cast<float>(std::clamp(farther_between * distances[i], 0.0, asked[i].most)));
      }
      asked.clear(), which.clear();
    };
    for (const std::uint32_t t : triangles) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const double tangents = std::max({tangents_leave(a, b), tangents_leave(b, c), tangents_leave(c, a)});
      const double told = static_cast<double>(farthest(known_[t]));
      if (told > tolerance || told < least || tangents * 2 / 3 <= near * tolerance) continue;
      for (const Vec3& shares : places) {
        const PointNearSurface point = between(t, shares);
        if (point.most <= told) continue;
        asked.push_back(point);
        asked.back().ahead = normal_of(t);
        which.push_back(t);
      }
      if (asked.size() >= asked_at_once) know_asked();
    }
    know_asked();
  };
  const auto corners = [](double a, double b, double c) {
    return std::array<Vec3, 3>{{{a, b, c}, {b, c, a}, {c, a, b}}};
  };
  ask_at(corners(0.5, 0.25, 0.25), 0);
  ask_at(corners(0.75, 0.125, 0.125), near * tolerance);
  ask_at(corners(0.5, 0.375, 0.125), near * tolerance);
  ask_at(corners(0.5, 0.125, 0.375), near * tolerance);
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

float RefinableMesh::farthest(const Known& known) {
  float result = 0;
  for (const float d : {known.edge[0], known.edge[1], known.edge[2], known.middle})
    if (d != unknown) result = std::max(result, std::fabs(d));
  return result;
}

double RefinableMesh::distance_of(std::uint32_t triangle) const {
  float result = farthest(known_[triangle]);
  for (const std::uint32_t p : mesh_.triangles[triangle]) result = std::max(result, distances_[p]);
  return static_cast<double>(result);
}

RefinableMesh::Far RefinableMesh::what_is_far(double tolerance) const {
  Far far;
  double most = tolerance;
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    const double distance = distance_of(t);
    if (!(distance > tolerance)) continue;
    ++far.triangles;
    if (distance > most) most = distance, far.place = mesh_.points[mesh_.triangles[t][0]];
  }
  return far;
}

double RefinableMesh::distance() const {
  float largest = distances_.empty() ? 0 : *std::max_element(distances_.begin(), distances_.end());
  for (const Known& k : known_) largest = std::max(largest, farthest(k));
  return largest;
}

double RefinableMesh::triangles_for(double tolerance) const {
  double sum = 0;
  for (const Known& k : known_) sum += parts_for(static_cast<double>(farthest(k)) / tolerance);
  return sum;
}

void RefinableMesh::mark_around_far(double tolerance, double reach, std::span<const Vec3> points,
                                    std::span<char> marks) const {
  std::vector<Box3> far;
  for (std::uint32_t t = 0; t < known_.size(); ++t) {
    if (!(distance_of(t) > tolerance)) continue;
    Box3 box;
    for (const std::uint32_t p : mesh_.triangles[t]) box.extend(mesh_.points[p]);
    for (std::size_t axis = 0; axis < 3; ++axis) box.min[axis] -= reach, box.max[axis] += reach;
    far.push_back(box);
  }
  std::sort(far.begin(), far.end(), [](const Box3& a, const Box3& b) { return a.min.x < b.min.x; });
  double widest = 0;
  for (const Box3& box : far) widest = std::max(widest, box.max.x - box.min.x);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x;
    auto box =
        std::lower_bound(far.begin(), far.end(), x - widest, [](const Box3& b, double at) { return b.min.x < at; });
    for (; box != far.end() && box->min.x <= x && marks[i] == 0; ++box)
      if (box->intersects({points[i], points[i]})) marks[i] = 1;
  }
}

// By edges: of small triangles' middles, only what they are at most is known.
double RefinableMesh::triangles_for_curves(double tolerance) const {
  double sum = 0;
  for (const Known& k : known_) {
    float most = 0;
    for (const float edge : k.edge)
      if (edge != unknown) most = std::max(most, std::fabs(edge));
    sum += std::min(1.0, static_cast<double>(most) / tolerance);
  }
  return sum;
}

}  // namespace meso::implicit
