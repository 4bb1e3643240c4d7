// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_miters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam_graph_cuts.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double no_turn = 1e-14;       // between two numbers there is no third one
constexpr int looks = 360;              // around a stub
constexpr double least_opening = 1e-3;  // radians
constexpr double parallel = 1e-12;      // of the square of a sine
constexpr double straight_gap = 1e-9;   // radians between circles that are one
constexpr double least_sight = 1e-7;    // of the ball: what is shorter is the root of rounding

}  // namespace

Vec3 Stub::outward(double turn) const { return std::cos(turn) * x + std::sin(turn) * y; }
Vec3 Stub::point(double turn, double along) const { return (radius + growth * along) * outward(turn) + along * axis; }
double Stub::turn_of(Vec3 p) const {
  const double turn = std::atan2(dot(p, y), dot(p, x));
  return turn < 0 ? turn + 2 * pi : turn;
}

NodeMiters::NodeMiters(double ball, std::vector<Stub> stubs) : ball_(ball), stubs_(std::move(stubs)) {}

/// |p|^2 - t^2 = (r + k t)^2, t = p . axis, along a line of the stub's surface: two points at most.
NodeMiters::Line NodeMiters::line(std::size_t stub, std::size_t other, double turn) const {
  const Stub &own = stubs_[stub], &cone = stubs_[other];
  const Vec3 e = own.outward(turn), a = own.radius * e, b = own.growth * e + own.axis;
  Line out{.height = dot(a, cone.axis), .climb = dot(b, cone.axis)};
  const double ta = out.height, tb = out.climb, ra = cone.radius + cone.growth * ta, rb = cone.growth * tb;
  const double c2 = dot(b, b) - tb * tb - rb * rb, c1 = dot(a, b) - ta * tb - ra * rb,
               c0 = dot(a, a) - ta * ta - ra * ra;
  const double square = c1 * c1 - c0 * c2;
  if (c2 < parallel) return out;
  const double root = std::sqrt(std::max(0.0, square)), both = c1 > 0 ? -c1 - root : root - c1;
  const double one = both / c2, two = square > 0 && both != 0 ? c0 / both : -c1 / c2;
  out.meets = square > 0;
  out.first = std::min(one, two);
  out.last = std::max(one, two);
  return out;
}

NodeMiters::Hidden NodeMiters::hidden(std::size_t stub, std::size_t other, double turn) const {
  const Line l = line(stub, other, turn);
  const Stub& cone = stubs_[other];
  const double height = l.height + l.last * l.climb;
  if (!l.meets || l.last <= 0) return {};
  if (height <= 0) return {};                              // it leaves through the base, which the ball hides
  if (cone.radius + cone.growth * height <= 0) return {};  // beyond the tip
  return {l.climb > 0 ? std::max(l.first, -l.height / l.climb) : l.first, l.last};
}

bool NodeMiters::are_opposite(std::size_t a, std::size_t b) const {
  const Stub &p = stubs_[a], &q = stubs_[b];
  if (angle_between(p.axis, -q.axis) > straight_gap) return false;
  return p.leaves_ball + q.leaves_ball <= straight_gap * ball_;
}

/// A stub that shows no ball ends at the one across.
int NodeMiters::shown(std::size_t stub, int other) const {
  if (other != at_ball) return other;
  for (std::size_t i = 0; i < stubs_.size(); ++i)
    if (i != stub && are_opposite(stub, i)) return static_cast<int>(i);
  return at_ball;
}

NodeMiters::Borders NodeMiters::borders(std::size_t stub, double turn) const {
  struct Range {
    Hidden hidden;
    std::size_t other;
  };
  std::vector<Range> ranges;
  double reached = stubs_[stub].leaves_ball;
  for (std::size_t i = 0; i < stubs_.size(); ++i) {
    if (i == stub) continue;
    const Hidden range = hidden(stub, i, turn);
    if (range.to > reached) ranges.push_back({range, i});
  }
  std::ranges::sort(ranges, {}, [](const Range& r) { return r.hidden.from; });
  Borders out;
  std::size_t last = 0;
  for (const Range& r : ranges) {
    if (r.hidden.from > reached + least_sight * ball_) {
      out.push_back(last);
      out.push_back(2 * r.other + 2);
    }
    if (r.hidden.to <= reached) continue;
    reached = r.hidden.to;
    last = 2 * r.other + 1;
  }
  out.push_back(last);
  std::ranges::sort(out);
  return out;
}

void NodeMiters::part(std::size_t stub, double from, const Borders& first, double to, const Borders& last,
                      std::vector<Corner>& out) const {
  if (first == last) return;
  const double middle = (from + to) / 2;
  if (to - from <= no_turn || middle <= from || middle >= to) {
    out.push_back({to, first, last});
    return;
  }
  const Borders between = borders(stub, middle);
  part(stub, from, first, middle, between, out);
  part(stub, middle, between, to, last, out);
}

bool NodeMiters::find() {
  for (std::size_t a = 0; a < stubs_.size(); ++a)
    for (std::size_t b = 0; b < stubs_.size(); ++b) {
      const Stub &p = stubs_[a], &q = stubs_[b];
      // Half the cone's opening and half the other's are as much as the angle between them.
      if (a < b && angle_between(p.axis, q.axis) <
                       std::atan(std::max(0.0, p.growth)) + std::atan(std::max(0.0, q.growth)) + least_opening)
        return false;
    }
  mitres_.resize(stubs_.size());
  for (std::size_t stub = 0; stub < stubs_.size(); ++stub) {
    constexpr double step = 2 * pi / looks;
    constexpr double beside = 0.37 * step;  // struts that stand at right angles meet at turns that are not looked at
    std::vector<Corner> corners;
    const Borders start = borders(stub, beside);
    Borders before = start;
    for (int i = 1; i <= looks; ++i) {
      Borders here = i == looks ? start : borders(stub, beside + i * step);
      part(stub, beside + (i - 1) * step, before, beside + i * step, here, corners);
      before = std::move(here);
    }
    const auto add = [&](double from, double to, std::size_t border) {
      const double off = from >= 2 * pi ? 2 * pi : 0;
      const int other = border == 0 ? at_ball : static_cast<int>((border - 1) / 2);
      mitres_[stub].push_back({from - off, to - off, shown(stub, other), border > 0 && border % 2 == 0});
    };
    const auto has = [](const Borders& b, std::size_t border) { return std::ranges::count(b, border) > 0; };
    for (std::size_t border = 0; border < 2 * stubs_.size() + 1; ++border) {
      if (corners.empty() && has(start, border)) add(0, 2 * pi, border);
      bool ends = false;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        if (has(corners[c].before, border) || !has(corners[c].behind, border)) continue;
        std::size_t k = c + 1;
        while (k < c + corners.size() && has(corners[k % corners.size()].behind, border)) ++k;
        add(corners[c].turn, corners[k % corners.size()].turn + (k < corners.size() ? 0 : 2 * pi), border);
        ends = true;
      }
      if (!ends && !corners.empty() && has(start, border)) add(0, 2 * pi, border);
    }
  }
  return true;
}

double NodeMiters::along(std::size_t stub, const Mitre& mitre, double turn) const {
  if (mitre.other == at_ball) return stubs_[stub].leaves_ball;
  const auto other = static_cast<std::size_t>(mitre.other);
  if (are_opposite(stub, other)) return stubs_[stub].leaves_ball;
  const Line l = line(stub, other, turn);
  return mitre.goes_in ? l.first : l.last;
}

Vec3 NodeMiters::point(std::size_t stub, const Mitre& mitre, double turn) const {
  return stubs_[stub].point(turn, along(stub, mitre, turn));
}

Vec3 NodeMiters::tangent(std::size_t stub, const Mitre& mitre, double turn) const {
  const Stub &own = stubs_[stub], &cone = stubs_[static_cast<std::size_t>(mitre.other)];
  const double s = along(stub, mitre, turn), radius = own.radius + own.growth * s;
  const Vec3 e = own.outward(turn), p = radius * e + s * own.axis;
  const double t = dot(p, cone.axis);
  const Vec3 gradient = p - (t + (cone.radius + cone.growth * t) * cone.growth) * cone.axis;
  const Vec3 around = radius * (std::cos(turn) * own.y - std::sin(turn) * own.x), up = own.growth * e + own.axis;
  return around - (dot(gradient, around) / dot(gradient, up)) * up;
}

double NodeMiters::farthest(std::size_t stub) const {
  double most = stubs_[stub].leaves_ball;
  for (const Mitre& m : mitres_[stub])
    for (int i = 0; i <= 16; ++i) most = std::max(most, along(stub, m, m.from + (m.to - m.from) * i / 16));
  return most;
}

}  // namespace meso::brep
