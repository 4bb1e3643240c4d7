// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_rings.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double same_vertex = 1e-7;  // millimetres

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

double turn_about(const AxisFrame& frame, Vec3 p) {
  const Vec3 v = p - frame.origin;
  const double turn = std::atan2(dot(v, cross(frame.z, frame.x)), dot(v, frame.x));
  return turn < 0 ? turn + 2 * pi : turn;
}

Vec3 at_turn(const AxisFrame& frame, double radius, double turn) {
  return frame.origin + radius * (std::cos(turn) * frame.x + std::sin(turn) * cross(frame.z, frame.x));
}

/// In the middle of the widest gap between turns; 0 if there are none.
double widest_gap(std::vector<double> turns) {
  if (turns.empty()) return 0;
  std::ranges::sort(turns);
  double widest = 0, middle = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double next = i + 1 < turns.size() ? turns[i + 1] : turns[0] + 2 * pi;
    if (next - turns[i] <= widest + 1e-9) continue;  // of equal ones the first
    widest = next - turns[i];
    middle = turns[i] + widest / 2;
  }
  return middle;
}

}  // namespace

Rings::Rings(const Joints& joints, const std::vector<BallCuts>& cuts, Template& geometry) {
  make_rings(joints);
  mark_contacts(joints, geometry);
  mark_cuts(joints, cuts, geometry);
  mark_seams(joints, geometry);
  make_edges(geometry);
  add_seams(joints, geometry);
  add_cuts(joints, geometry);
}

void Rings::add_seams(const Joints& joints, Template& geometry) {
  for (std::uint32_t s = 0; s < seams_.size(); ++s) {
    if (joints.is_swallowed[s]) continue;
    Seam& seam = seams_[s];
    seam.edge = static_cast<std::uint32_t>(geometry.edges.size());
    const Vec3 from = geometry.vertices[seam.vertex[0]], to = geometry.vertices[seam.vertex[1]];
    geometry.edges.push_back({.curve = Line{from, unit(to - from)}, .vertex = seam.vertex});
  }
}

void Rings::add_cuts(const Joints& joints, Template& geometry) {
  for (std::uint32_t n = 0; n < cuts_.size(); ++n) {
    const BeamGraph::Node& node = joints.graph.nodes[n];
    for (CutEdge& cut : cuts_[n]) {
      const Vec3 x = unit(geometry.vertices[cut.vertex[0]] - node.position);
      const Vec3 z = unit(cross(x, geometry.vertices[cut.vertex[1]] - node.position));
      cut.edge = static_cast<std::uint32_t>(geometry.edges.size());
      geometry.edges.push_back({.curve = Circle{{node.position, z, x}, node.radius}, .vertex = cut.vertex});
    }
  }
}

void Rings::make_rings(const Joints& joints) {
  const auto add = [&](Leaving l) {
    const Vec3 away = joints.direction(l), first = joints.direction(l - l % 2);
    const Vec3 centre = joints.graph.nodes[joints.node(l)].position + joints.end(l).along * away;
    rings_.push_back({.frame = {centre, away, across(first)}, .radius = joints.end(l).radius, .marks = {}});
    use_[l] = {static_cast<std::uint32_t>(rings_.size() - 1), true};
  };
  use_.resize(2 * joints.graph.struts.size());
  seams_.resize(joints.graph.struts.size());
  for (Leaving l = 0; l < use_.size(); ++l) {
    if (l % 2 == 1 && joints.is_swallowed[l / 2]) {
      use_[l] = {use_[l - 1].ring, false};
      continue;
    }
    const std::uint32_t node = joints.node(l);
    if (joints.is_straight[node] && joints.leaving[node][1] == l)
      use_[l] = {use_[joints.leaving[node][0]].ring, false};
    else
      add(l);
  }
}

/// A vertex that is there already is taken: two balls that meet may both divide their circle in it.
std::uint32_t Rings::mark(Leaving l, Vec3 p, bool is_contact, Template& geometry) {
  for (const Ring::Mark& m : rings_[use_[l].ring].marks)
    if (norm(geometry.vertices[m.vertex] - p) < same_vertex) return m.vertex;
  geometry.vertices.push_back(p);
  const auto vertex = static_cast<std::uint32_t>(geometry.vertices.size() - 1);
  mark(l, p, vertex, is_contact);
  return vertex;
}

void Rings::mark(Leaving l, Vec3 p, std::uint32_t vertex, bool is_contact) {
  Ring& ring = rings_[use_[l].ring];
  ring.marks.push_back({turn_about(ring.frame, p), vertex, is_contact});
}

void Rings::mark_contacts(const Joints& joints, Template& geometry) {
  for (const auto& [a, b] : joints.touching) {
    const Vec3 u = joints.direction(a), v = joints.direction(b);
    const double first = joints.end(a).angle, both = first + joints.end(b).angle;
    const double between = angle_between(u, v),
                 part = between * first / both;  // along the arc from one axis to the other
    const Vec3 p = (std::sin(between - part) * u + std::sin(part) * v) / std::sin(between);
    const BeamGraph::Node& node = joints.graph.nodes[joints.node(a)];
    const std::uint32_t vertex = mark(a, node.position + node.radius * p, true, geometry);
    mark(b, geometry.vertices[vertex], vertex, true);
  }
}

void Rings::mark_cuts(const Joints& joints, const std::vector<BallCuts>& cuts, Template& geometry) {
  cuts_.resize(cuts.size());
  for (std::uint32_t n = 0; n < cuts.size(); ++n) {
    const BeamGraph::Node& node = joints.graph.nodes[n];
    const auto& leaving = joints.leaving[n];
    const auto first_point = static_cast<std::uint32_t>(geometry.vertices.size());
    for (const Vec3& p : cuts[n].points) geometry.vertices.push_back(node.position + node.radius * p);
    const auto direction = [&](std::uint32_t site) {
      return site < leaving.size() ? joints.direction(leaving[site]) : cuts[n].points[site - leaving.size()];
    };
    for (const BallCuts::Cut& cut : cuts[n].cuts) {
      CutEdge& added = cuts_[n].emplace_back();
      for (const std::size_t end : {0u, 1u}) {
        const std::uint32_t site = cut[end];
        if (site >= leaving.size()) {
          added.vertex[end] = first_point + site - static_cast<std::uint32_t>(leaving.size());
          continue;
        }
        const Ring& ring = rings_[use_[leaving[site]].ring];
        const Vec3 axis = direction(site), way = direction(cut[1 - end]);
        const Vec3 p = ring.frame.origin + ring.radius * unit(way - dot(way, axis) * axis);
        added.vertex[end] = mark(leaving[site], p, false, geometry);
      }
    }
  }
}

void Rings::mark_seams(const Joints& joints, Template& geometry) {
  for (std::uint32_t s = 0; s < joints.graph.struts.size(); ++s) {
    const Ring& first = rings_[use_[2 * s].ring];
    if (joints.is_swallowed[s]) {
      if (first.marks.empty()) (void)mark(2 * s, at_turn(first.frame, first.radius, 0), false, geometry);
      continue;
    }
    const Vec3 axis = joints.direction(2 * s);
    AxisFrame frame{first.frame.origin, axis, across(axis)};
    std::vector<double> turns;
    for (const std::uint32_t end : {0u, 1u})
      for (const Ring::Mark& m : rings_[use_[2 * s + end].ring].marks)
        turns.push_back(turn_about(frame, geometry.vertices[m.vertex]));
    const double turn = widest_gap(std::move(turns));
    seams_[s].direction = at_turn({{}, axis, frame.x}, 1, turn);
    for (const std::uint32_t end : {0u, 1u}) {
      const Ring& ring = rings_[use_[2 * s + end].ring];
      seams_[s].vertex[end] = mark(2 * s + end, ring.frame.origin + ring.radius * seams_[s].direction, false, geometry);
    }
  }
}

void Rings::make_edges(Template& geometry) {
  for (Ring& ring : rings_) {
    std::ranges::sort(ring.marks, {}, [](const Ring::Mark& m) { return std::pair(m.turn, m.vertex); });
    ring.first_edge = static_cast<std::uint32_t>(geometry.edges.size());
    for (std::size_t k = 0; k < ring.marks.size(); ++k)
      geometry.edges.push_back({.curve = Circle{ring.frame, ring.radius},
                                .vertex = {ring.marks[k].vertex, ring.marks[(k + 1) % ring.marks.size()].vertex}});
  }
}

std::vector<Coedge> Rings::around(Leaving l, std::uint32_t vertex) const {
  const Ring& at = ring(l);
  const auto count = static_cast<std::uint32_t>(at.marks.size());
  const auto found = std::ranges::find(at.marks, vertex, &Ring::Mark::vertex);
  assert(found != at.marks.end());
  const auto first = static_cast<std::uint32_t>(found - at.marks.begin());
  std::vector<Coedge> out;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t step = use_[l].forward ? k : count - 1 - k;
    out.push_back({.edge = at.first_edge + (first + step) % count, .reversed = !use_[l].forward});
  }
  return out;
}

int sides_of(double radius, double deflection, double angle) {
  const double by_angle = 2 * pi / std::max(1e-3, angle);
  const double by_deflection = pi / std::acos(std::clamp(1 - deflection / radius, 0.0, 1 - 1e-9));
  return static_cast<int>(std::ceil(std::max({8.0, by_angle, by_deflection})));
}

std::vector<Vec3> inner_points(const EdgeTemplate& edge, const Template& geometry, int sides) {
  const auto& circle = std::get<Circle>(edge.curve);
  const double first = turn_about(circle.frame, geometry.vertices[edge.vertex[0]]);
  double last = edge.vertex[0] == edge.vertex[1] ? first : turn_about(circle.frame, geometry.vertices[edge.vertex[1]]);
  if (last <= first) last += 2 * pi;
  const int parts = std::max(1, static_cast<int>(std::ceil(sides * (last - first) / (2 * pi) - 1e-9)));
  std::vector<Vec3> out;
  for (int i = 1; i < parts; ++i)
    out.push_back(at_turn(circle.frame, circle.radius, first + (last - first) * i / parts));
  return out;
}

}  // namespace meso::brep
