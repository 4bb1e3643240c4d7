// SPDX-License-Identifier: Apache-2.0
#include "strut_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace meso::eval {
namespace {

Leaving leaving(Vec3 way, double radius, double far_radius) {
  const double length = norm(way);
  return {way / length, radius, std::max(0.0, (far_radius - radius) / length)};
}

double key_of(Vec3 p) { return dot(p, Vec3{0.4242, 0.5656, 0.7071}); }  // a unit vector, nearly

}  // namespace

Leaving leaving_start(const BeamsShape& beams, const Strut& s) {
  return leaving(beams.nodes[s.to].position - beams.nodes[s.from].position, s.radius_from, s.radius_to);
}

Leaving leaving_end(const BeamsShape& beams, const Strut& s) {
  return leaving(beams.nodes[s.from].position - beams.nodes[s.to].position, s.radius_to, s.radius_from);
}

// Cones of radius r at a node, that grow by k per length away from it and whose axes meet at the angle theta, have left
// each other at the distance r / (sin(theta / 2) - k cos(theta / 2)).
Parting part(const Leaving& strut, Vec3 direction, double& radius) {
  // |a - b| = 2 sin(theta / 2), |a + b| = 2 cos(theta / 2) for unit vectors, exact also for small angles.
  const double sine = norm(strut.direction - direction) / 2, cosine = norm(strut.direction + direction) / 2;
  if (sine < smallest_sine) return Parting::same_direction;
  const double opening = sine - strut.widening * cosine;
  if (opening < smallest_sine) return Parting::grow_faster;
  radius = std::max(radius, strut.radius / opening);
  return Parting::fine;
}

Parting part(const Leaving& a, const Leaving& b, double& radius) {
  const Leaving larger{a.direction, std::max(a.radius, b.radius), std::max(a.widening, b.widening)};
  return part(larger, b.direction, radius);
}

std::size_t PoleBalls::find(Vec3 p) const {
  const double key = key_of(p);
  const auto last = by_key_.upper_bound(key + same_point);
  for (auto it = by_key_.lower_bound(key - same_point); it != last; ++it)
    if (norm(poles_[it->second].place - p) <= same_point) return it->second;
  return poles_.size();
}

void PoleBalls::add(Vec3 pole, Vec3 far, const Leaving& strut) {
  const std::size_t number = find(pole);
  if (number == poles_.size()) {
    poles_.push_back({pole});
    by_key_.emplace(key_of(pole), number);
  }
  poles_[number].ends.push_back({far, strut});
}

void PoleBalls::measure() {
  for (Pole& pole : poles_) {
    pole.ball = ball_of(pole.ends);
    pole.ends = {};
  }
}

/// Only struts that leave in nearly the same direction can ask for a larger ball than is known, so they are looked at
/// in the order of one coordinate of their directions.
PoleBalls::Ball PoleBalls::ball_of(std::vector<End>& ends) {
  std::ranges::stable_sort(ends, {}, [](const End& e) { return e.strut.direction.x; });
  Ball ball;
  double widest = 0;
  for (const End& end : ends) {
    ball.radius = std::max(ball.radius, end.strut.radius);
    widest = std::max(widest, end.strut.widening);
  }
  const double thickest = ball.radius;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = i; j-- > 0;) {
      const double apart = ends[i].strut.direction.x - ends[j].strut.direction.x;
      if (apart > 2 * (thickest / ball.radius + widest)) break;
      if (norm(ends[i].far - ends[j].far) <= same_point) continue;  // the mapping makes them one
      const Parting parting = part(ends[i].strut, ends[j].strut, ball.radius);
      if (parting != Parting::fine) return {0, parting};
    }
  return ball;
}

PoleBalls::Ball PoleBalls::at(Vec3 p) const {
  const std::size_t number = find(p);
  assert(number < poles_.size());
  return poles_[number].ball;
}

}  // namespace meso::eval
