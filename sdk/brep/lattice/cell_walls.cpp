// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_walls.hpp"

#include <algorithm>
#include <cmath>

namespace meso::brep {
namespace {

constexpr int points_of_edge = 12;  ///< that stand for it

struct Flat {
  double x = 0, y = 0;
};

double twice_area(const std::vector<Flat>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Flat &a = loop[i], &b = loop[(i + 1) % loop.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

bool contains(const std::vector<Flat>& loop, Flat p) {
  bool in = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Flat &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

class WallMaker {
 public:
  WallMaker(const JointedBox& box, CellEdges& edges) : box_(box), edges_(edges) {}

  void add(Side side, const std::vector<Coedge>& of_others) {
    for (const Coedge& use : of_others) uses_[side].push_back(turned(use));
  }

  /// Along the twelve edges of the box. False: what is in an edge ends where nothing else does.
  bool add_box_edges() {
    for (Side first = 0; first < 6; ++first)
      for (Side second = 0; second < first; ++second)
        if (first / 2 != second / 2 && !add_box_edge(first, second)) return false;
    return true;
  }

  bool add_faces(std::vector<FaceTemplate>& faces) const {
    for (Side side = 0; side < 6; ++side) {
      if (uses_[side].empty()) continue;
      const auto loops = chained(edges_, uses_[side]);
      if (loops.empty() || !add_faces(side, loops, faces)) return false;
    }
    return true;
  }

 private:
  /// Counter-clockwise about `first`; the other way about `second`.
  bool add_box_edge(Side first, Side second) {
    const Vec3 way = cross(outward(first), outward(second));
    const std::size_t axis = 3 - first / 2 - second / 2;
    Vec3 from = 0.5 * (box_.box.min + box_.box.max), to = from;
    for (const Side side : {first, second})
      from[side / 2] = to[side / 2] = (side % 2 == 0 ? box_.box.min : box_.box.max)[side / 2];
    from[axis] = (way[axis] > 0 ? box_.box.min : box_.box.max)[axis];
    to[axis] = (way[axis] > 0 ? box_.box.max : box_.box.min)[axis];
    const double length = norm(to - from);
    std::vector<std::array<double, 2>> spans;
    const auto note = [&](double low, double high) {
      low = std::max(low, 0.0);
      high = std::min(high, length);
      if (high - low > box_.tolerance) spans.push_back({low, high});
    };
    const BeamGraph& graph = box_.joints.graph;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
      if (!box_.has_ball[n]) continue;
      const Vec3 off = graph.nodes[n].position - from;
      const double along = dot(off, way), aside = norm(off - along * way);
      if (aside >= graph.nodes[n].radius) continue;
      const double half = std::sqrt(graph.nodes[n].radius * graph.nodes[n].radius - aside * aside);
      note(along - half, along + half);
    }
    for (std::uint32_t s = 0; s < graph.struts.size(); ++s) {
      const auto& sides = box_.in_sides[s];
      if (std::ranges::find(sides, first) == sides.end() || std::ranges::find(sides, second) == sides.end()) continue;
      const double a = dot(graph.nodes[graph.struts[s].node[0]].position - from, way),
                   b = dot(graph.nodes[graph.struts[s].node[1]].position - from, way);
      note(std::min(a, b), std::max(a, b));
    }
    std::ranges::sort(spans);
    for (std::size_t i = 0; i < spans.size();) {
      auto [low, high] = spans[i];
      for (++i; i < spans.size() && spans[i][0] <= high + box_.tolerance; ++i) high = std::max(high, spans[i][1]);
      if (!add_span(first, second, from + low * way, from + high * way, low == 0, high == length)) return false;
    }
    return true;
  }
  /// `opens`, `closes`: the span starts or ends in a corner of the box.
  bool add_span(Side first, Side second, Vec3 from, Vec3 to, bool opens, bool closes) {
    const std::uint32_t start = edges_.find(from), end = edges_.find(to);
    const bool knows_start = norm_to(start, from) <= box_.tolerance, knows_end = norm_to(end, to) <= box_.tolerance;
    if ((!knows_start && !opens) || (!knows_end && !closes)) return false;
    const Coedge use = edges_.line(edges_.vertex(from), edges_.vertex(to));
    uses_[first].push_back(use);
    uses_[second].push_back(turned(use));
    return true;
  }
  [[nodiscard]] double norm_to(std::uint32_t vertex, Vec3 p) const {
    return vertex < edges_.count() ? norm(edges_.at(vertex) - p) : HUGE_VAL;
  }

  bool add_faces(Side side, const std::vector<std::vector<Coedge>>& loops, std::vector<FaceTemplate>& faces) const {
    const Vec3 z = outward(side), x = outward((side / 2 * 2 + 3) % 6), y = cross(z, x);
    std::vector<std::vector<Flat>> flat;
    for (const auto& loop : loops) {
      auto& points = flat.emplace_back();
      for (const Coedge& use : loop)
        for (const Vec3 p : edges_.points(use, points_of_edge)) points.push_back({dot(p, x), dot(p, y)});
    }
    Vec3 origin = box_.box.min;
    if (side % 2 != 0) origin = box_.box.max;
    std::vector<std::size_t> face_of(loops.size());
    for (std::size_t l = 0; l < loops.size(); ++l) {
      if (twice_area(flat[l]) <= 0) continue;
      face_of[l] = faces.size();
      faces.push_back({.surface = Plane{{origin, z, x}}, .loops = {loops[l]}, .moments = {}, .box = {}, .mesh = {}});
    }
    for (std::size_t l = 0; l < loops.size(); ++l) {
      if (twice_area(flat[l]) > 0) continue;
      std::optional<std::size_t> owner;
      for (std::size_t m = 0; m < loops.size(); ++m) {
        if (twice_area(flat[m]) <= 0 || !contains(flat[m], flat[l].front())) continue;
        if (!owner || twice_area(flat[m]) < twice_area(flat[*owner])) owner = m;
      }
      if (!owner) return false;
      faces[face_of[*owner]].loops.push_back(loops[l]);
    }
    return true;
  }

  const JointedBox& box_;
  CellEdges& edges_;
  std::array<std::vector<Coedge>, 6> uses_;
};

}  // namespace

bool add_walls(const JointedBox& box, const BallSectors& sectors, const std::array<std::vector<Coedge>, 6>& lines,
               CellEdges& edges, std::vector<FaceTemplate>& faces, std::string& why) {
  WallMaker walls(box, edges);
  for (Side side = 0; side < 6; ++side) {
    walls.add(side, sectors.in_side(side));
    walls.add(side, lines[side]);
  }
  if (walls.add_box_edges() && walls.add_faces(faces)) return true;
  why = "the faces in a side of the box do not close";
  return false;
}

}  // namespace meso::brep
