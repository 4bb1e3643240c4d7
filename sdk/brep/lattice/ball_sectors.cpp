// SPDX-License-Identifier: Apache-2.0
#include "lattice/ball_sectors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam_graph_ball_faces.hpp"
#include "lattice/sector_cuts.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double margin = 1e-6;    ///< radians by which a point is in a cap
constexpr int azimuths = 16;       ///< at which a seam is tried
constexpr int points_of_arc = 12;  ///< that stand for it

using Place = JointedBox::Place;

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

/// From `axis`, that far towards `other`.
Vec3 towards(Vec3 axis, Vec3 other, double angle) {
  return std::cos(angle) * axis + std::sin(angle) * unit(other - dot(other, axis) * axis);
}

/// Circles far apart would need no cuts, but a face between all of them no axis is off.
std::vector<BallCap> nearly_touching(std::vector<BallCap> caps) {
  constexpr double apart = 0.05;
  double least = pi;
  for (std::size_t j = 0; j < caps.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      least = std::min(least, angle_between(caps[i].axis, caps[j].axis) - caps[i].angle - caps[j].angle);
  if (caps.size() > 2 && least > apart)
    for (BallCap& cap : caps) cap.angle += (least - apart) / 2;
  return caps;
}

}  // namespace

BallSectors::BallSectors(const JointedBox& box, CellEdges& edges) : box_(box), edges_(edges) {
  for (std::uint32_t n = 0; n < box.joints.graph.nodes.size(); ++n)
    if (box.has_ball[n] && box.joints.graph.nodes[n].radius > 0) balls_.push_back(ball_of(n));
}

BallSectors::Ball BallSectors::ball_of(std::uint32_t node) const {
  Ball ball{.node = node, .caps = {}, .cuts = {}, .arcs = {}};
  for (const Leaving l : box_.joints.leaving[node])
    if (box_.places[l / 2] != Place::beyond)
      ball.caps.push_back(
          {.axis = box_.joints.direction(l), .angle = box_.joints.end(l).angle, .strut = l, .side = {}, .marks = {}});
  for (Side side = 0; side < 6; ++side)
    if (const double depth = box_.depth(centre(ball), side); depth < radius(ball))
      ball.caps.push_back({.axis = outward(side),
                           .angle = depth == 0 ? pi / 2 : std::acos(depth / radius(ball)),
                           .strut = {},
                           .side = side,
                           .marks = {}});
  return ball;
}

Vec3 BallSectors::seen(const Ball& ball, std::uint32_t vertex) const { return unit(edges_.at(vertex) - centre(ball)); }

bool BallSectors::is_covered(const Ball& ball, Vec3 p, double by) {
  return std::ranges::any_of(ball.caps, [&](const Cap& cap) { return angle_between(cap.axis, p) < cap.angle - by; });
}

bool BallSectors::runs_in(const Cap& strut, const Cap& side) const {
  const auto& sides = box_.in_sides[*strut.strut / 2];
  return std::ranges::find(sides, *side.side) != sides.end();
}

void BallSectors::mark(Ball& ball, std::size_t cap, Vec3 p) {
  const std::uint32_t vertex = edges_.vertex(centre(ball) + radius(ball) * p);
  auto& marks = ball.caps[cap].marks;
  if (std::ranges::find(marks, vertex) == marks.end()) marks.push_back(vertex);
}

/// Notes the points in which two circles touch or cross. False: in another way.
bool BallSectors::meet(Ball& ball, std::size_t i, std::size_t j) {
  const Cap &a = ball.caps[i], &b = ball.caps[j];
  const double between = angle_between(a.axis, b.axis), gap = between - a.angle - b.angle;
  if (gap > touching_gap) return true;
  std::vector<Vec3> points;
  if (gap >= -touching_gap) {
    if (between > pi - margin) return false;
    points.push_back(towards(a.axis, b.axis, a.angle + gap / 2));
  } else {
    const bool crosses = (a.side && b.side) || (a.strut && b.side && runs_in(a, b));
    if (!crosses) return false;
    const double c = std::cos(between), rest = 1 - c * c;
    const double x = (std::cos(a.angle) - c * std::cos(b.angle)) / rest,
                 y = (std::cos(b.angle) - c * std::cos(a.angle)) / rest;
    const double square = (1 - (x * x + y * y + 2 * x * y * c)) / rest;
    if (square < margin) return false;
    for (const double sign : {-1.0, 1.0})
      points.push_back(x * a.axis + y * b.axis + sign * std::sqrt(square) * cross(a.axis, b.axis));
  }
  for (const Vec3 p : points) {
    if (is_covered(ball, p, margin)) continue;
    mark(ball, i, p);
    mark(ball, j, p);
  }
  return true;
}

void BallSectors::cut_between(Ball& ball, const BallCap& a, const BallCap& b) {
  const Vec3 from = a.angle > 0 ? towards(a.axis, b.axis, a.angle) : a.axis,
             to = b.angle > 0 ? towards(b.axis, a.axis, b.angle) : b.axis;
  const std::uint32_t first = edges_.vertex(centre(ball) + radius(ball) * from),
                      second = edges_.vertex(centre(ball) + radius(ball) * to);
  ball.cuts.push_back({first, second});
  for (const auto& [end, vertex] : {std::pair{a, first}, {b, second}})
    for (Cap& cap : ball.caps)
      if (end.angle > 0 && cap.angle == end.angle && norm(cap.axis - end.axis) < margin &&
          std::ranges::find(cap.marks, vertex) == cap.marks.end())
        cap.marks.push_back(vertex);
}

/// OpenCASCADE reads faces wrongly that nearly meet themselves, see beam_graph_cuts.hpp.
void BallSectors::cut(Ball& ball) {
  std::vector<BallCap> caps;
  for (const Cap& cap : ball.caps) caps.push_back({cap.axis, cap.angle});
  if (std::ranges::none_of(ball.caps, [](const Cap& cap) { return cap.side.has_value(); })) {
    const BallCuts cuts = cuts_between(nearly_touching(caps));
    for (const Vec3 p : cuts.points) caps.push_back({p, 0});
    for (const auto& [a, b] : cuts.cuts) cut_between(ball, caps[a], caps[b]);
    return;
  }
  std::vector<bool> is_on_border;
  for (const Cap& cap : ball.caps) is_on_border.push_back(cap.side || box_.places[*cap.strut / 2] == Place::in_sides);
  const Border border = std::ranges::count(is_on_border, true) == 1 ? Border::linked : Border::as_it_is;
  for (const auto& [a, b] : sector_cuts(caps, is_on_border, border)) cut_between(ball, caps[a], caps[b]);
}

/// One line along each strut that is free in the box, as far from all corners of its two circles as may be.
void BallSectors::add_seams() {
  std::map<Leaving, std::pair<Ball*, Cap*>> ends;
  for (Ball& ball : balls_)
    for (Cap& cap : ball.caps)
      if (cap.strut) ends[*cap.strut] = {&ball, &cap};
  const auto on_ring = [&](Leaving l, Vec3 way) {
    const auto& [ball, cap] = ends.at(l);
    return centre(*ball) + radius(*ball) * (std::cos(cap->angle) * cap->axis + std::sin(cap->angle) * way);
  };
  for (const auto& [l, end] : ends) {
    if (l % 2 != 0 || box_.places[l / 2] != Place::inside || !ends.contains(l + 1)) continue;
    const Vec3 axis = end.second->axis, x = across(axis), y = cross(axis, x);
    Vec3 best;
    double most = -1;
    for (int k = 0; k < azimuths; ++k) {
      const Vec3 way = std::cos(2 * pi * k / azimuths) * x + std::sin(2 * pi * k / azimuths) * y;
      double least = pi;
      for (const Leaving at : {l, l + 1})
        for (const std::uint32_t v : ends.at(at).second->marks) {
          const Vec3 other = edges_.at(v) - centre(*end.first);
          least = std::min(least, angle_between(way, unit(other - dot(other, axis) * axis)));
        }
      if (least > most + margin) {
        most = least;
        best = way;
      }
    }
    for (const Leaving at : {l, l + 1}) {
      seams_[at] = edges_.vertex(on_ring(at, best));
      ends.at(at).second->marks.push_back(seams_[at]);
      if (box_.joints.is_swallowed[l / 2]) ends.at(l + 1).second->marks.push_back(seams_[at]);
      if (box_.joints.is_swallowed[l / 2]) break;  // there is one circle
    }
  }
}

void BallSectors::add_arcs(Ball& ball) {
  const auto add = [&](Vec3 axis, double angle, std::uint32_t from, std::uint32_t to, bool is_cut) {
    const Coedge use = edges_.arc(centre(ball) + radius(ball) * std::cos(angle) * axis, axis,
                                  radius(ball) * std::sin(angle), from, to);
    ball.arcs.push_back({use, {.axis = axis, .angle = angle, .from = seen(ball, from), .to = seen(ball, to)}, is_cut});
    return use;
  };
  for (Cap& cap : ball.caps) {
    if (cap.strut) rings_[*cap.strut];
    if (cap.marks.empty()) {
      // Of a side, where the next box has it, too.
      const Vec3 p = towards(cap.axis, cap.side ? outward((*cap.side / 2 * 2 + 3) % 6) : across(cap.axis), cap.angle);
      if (!is_covered(ball, p, margin)) mark(ball, static_cast<std::size_t>(&cap - ball.caps.data()), p);
    }
    const Vec3 x = across(cap.axis), y = cross(x, cap.axis);
    const auto turn = [&](std::uint32_t v) { return std::atan2(dot(seen(ball, v), y), dot(seen(ball, v), x)); };
    std::ranges::sort(cap.marks, {}, turn);
    for (std::size_t m = 0; m < cap.marks.size(); ++m) {
      const std::uint32_t from = cap.marks[m], to = cap.marks[(m + 1) % cap.marks.size()];
      const double first = turn(from);
      double last = turn(to);
      if (m + 1 == cap.marks.size()) last += 2 * pi;
      const double middle = (first + last) / 2;
      const Vec3 p =
          std::cos(cap.angle) * cap.axis + std::sin(cap.angle) * (std::cos(middle) * x + std::sin(middle) * y);
      if (is_covered(ball, p, margin / 10)) continue;
      const Coedge use = add(cap.axis, cap.angle, from, to, false);
      (cap.strut ? rings_[*cap.strut] : in_sides_[*cap.side]).push_back(use);
    }
  }
  for (const auto& [a, b] : ball.cuts)
    for (const auto& [from, to] : {std::array{a, b}, {b, a}})
      (void)add(unit(cross(seen(ball, to), seen(ball, from))), pi / 2, from, to, true);
}

bool BallSectors::divide(std::string& why) {
  for (Ball& ball : balls_) {
    for (std::size_t j = 0; j < ball.caps.size(); ++j)
      for (std::size_t i = 0; i < j; ++i)
        if (!meet(ball, i, j)) {
          why = "circles on a ball meet";
          return false;
        }
    cut(ball);
  }
  add_seams();
  for (Ball& ball : balls_) add_arcs(ball);
  return true;
}

/// From the end of each arc to the one that begins there and turns most to the left, but not back along a cut.
std::vector<std::vector<std::size_t>> BallSectors::loops_of(const Ball& ball) const {
  std::vector<std::size_t> next(ball.arcs.size());
  std::vector<bool> is_next(ball.arcs.size(), false);
  for (std::size_t a = 0; a < ball.arcs.size(); ++a) {
    double most = -4;  // less than any turn
    for (std::size_t b = 0; b < ball.arcs.size(); ++b) {
      const Arc &from = ball.arcs[a], &to = ball.arcs[b];
      if (edges_.start(to.use) != edges_.end(from.use)) continue;
      if (from.is_cut && to.is_cut && from.use.edge == to.use.edge) continue;
      const double turn = turn_between(from.value, to.value);
      if (turn <= most) continue;
      most = turn;
      next[a] = b;
    }
    if (most == -4 || is_next[next[a]]) return {};
    is_next[next[a]] = true;
  }
  std::vector<std::vector<std::size_t>> loops;
  std::vector<bool> taken(ball.arcs.size(), false);
  for (std::size_t first = 0; first < ball.arcs.size(); ++first) {
    if (taken[first]) continue;
    auto& loop = loops.emplace_back();
    for (std::size_t a = first; !taken[a]; a = next[a]) {
      taken[a] = true;
      loop.push_back(a);
    }
  }
  return loops;
}

bool BallSectors::add_faces(int variant, std::vector<FaceTemplate>& faces, std::string& why) {
  for (const Ball& ball : balls_) {
    if (ball.arcs.empty() && !ball.caps.empty()) continue;
    const auto loops = loops_of(ball);
    if (loops.empty()) {
      why = "the circles on a ball bound no face";
      return false;
    }
    std::vector<UnitLoop> sampled;
    for (const auto& loop : loops) {
      auto& points = sampled.emplace_back();
      for (const std::size_t a : loop)
        for (const Vec3 p : edges_.points(ball.arcs[a].use, points_of_arc)) points.push_back(unit(p - centre(ball)));
    }
    for (const auto& members : loops_of_faces(sampled)) {
      FaceTemplate& face = faces.emplace_back();
      std::vector<UnitLoop> around;
      for (const std::size_t l : members) {
        around.push_back(sampled[l]);
        auto& uses = face.loops.emplace_back();
        for (const std::size_t a : loops[l]) uses.push_back(ball.arcs[a].use);
      }
      const auto axes = axes_off(centre(ball), around, variant);
      if (!axes) {
        why = "a face goes around its ball";
        return false;
      }
      face.surface = SphereSurface{*axes, radius(ball)};
    }
  }
  return true;
}

}  // namespace meso::brep
