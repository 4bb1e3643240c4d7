// SPDX-License-Identifier: Apache-2.0
// P(q) = p backwards. With the system's placement taken away, p = sum of linear parts + R1 R2 ... (sum of distance
// parts), where only the element's three coordinates differ from 0.
#include <algorithm>
#include <numbers>

#include "affine_inverse.hpp"
#include "primitives.hpp"

namespace meso::membership {
namespace {

constexpr double tiny = 1e-12;

struct Range {
  AxisKind kind;
  Vec3 direction;
  double from, to;

  [[nodiscard]] bool holds(double q) const { return q >= from && q <= to; }
  /// The same for an angle that is only known up to whole turns.
  [[nodiscard]] bool holds_angle(double angle) const {
    const double turn = 2 * std::numbers::pi;
    return from + std::fmod(std::fmod(angle - from, turn) + turn, turn) <= to;
  }
};

Vec3 turned_back(const Range& circular, double angle, Vec3 p) { return rotation(circular.direction, -angle) * p; }

/// The angle by which `from` must turn about the unit vector `axis` to point, seen along it, where `to` does.
double angle_between(Vec3 axis, Vec3 from, Vec3 to) {
  const Vec3 u = cross(axis, from);  // from, turned by a quarter
  return std::atan2(dot(u, to), dot(cross(u, axis), to));
}

/// Angles a with dot(rotation(axis, -a) p, normal) = value: at most two.
std::vector<double> solve_turn(Vec3 axis, Vec3 p, Vec3 normal, double value) {
  // The left side is along + c cos a + s sin a.
  const double along = dot(p, axis) * dot(normal, axis);
  const double c = dot(p, normal) - along, s = dot(cross(p, axis), normal);
  const double size = std::hypot(c, s), wanted = value - along;
  if (size <= tiny || std::abs(wanted) > size) return {};
  const double middle = std::atan2(s, c), half = std::acos(wanted / size);
  return {middle - half, middle + half};
}

Answer straight(const std::vector<Range>& s, Vec3 p) {
  const Mat3 columns = Mat3::from_columns(s[0].direction, s[1].direction, s[2].direction);
  const auto q = solve(columns, p);
  if (!q) return Answer::unknown;
  return known(s[0].holds(q->x) && s[1].holds(q->y) && s[2].holds(q->z));
}

/// p = q0 d0 + q1 d1 in the plane of the two.
bool in_parallelogram(const Range& a, const Range& b, Vec3 p) {
  const Vec3 n = cross(a.direction, b.direction);
  const double q_a = dot(cross(p, b.direction), n) / dot(n, n), q_b = dot(cross(a.direction, p), n) / dot(n, n);
  return a.holds(q_a) && b.holds(q_b);
}

Answer turned_once(const Range& turn, const std::vector<Range>& s, Vec3 p) {
  const Vec3 axis = turn.direction;
  const bool first_linear = s[0].kind == AxisKind::linear, second_linear = s[1].kind == AxisKind::linear;
  if (first_linear && second_linear) return Answer::unknown;
  if (!first_linear && !second_linear) {
    const auto angles = solve_turn(axis, p, cross(s[0].direction, s[1].direction), 0);
    return known(std::ranges::any_of(angles, [&](double angle) {
      return turn.holds_angle(angle) && in_parallelogram(s[0], s[1], turned_back(turn, angle, p));
    }));
  }
  const Range &linear = first_linear ? s[0] : s[1], &distance = first_linear ? s[1] : s[0];
  if (norm(cross(linear.direction, axis)) > tiny) return Answer::unknown;
  const double d_along = dot(distance.direction, axis);
  const Vec3 d_across = distance.direction - d_along * axis, across = p - dot(p, axis) * axis;
  if (norm(d_across) <= tiny) return Answer::unknown;
  const double q = norm(across) / norm(d_across);
  const double height = (dot(p, axis) - q * d_along) * dot(linear.direction, axis);
  return known(distance.holds(q) && linear.holds(height) && turn.holds_angle(angle_between(axis, d_across, across)));
}

Answer turned_twice(const Range& outer, const Range& inner, const Range& distance, Vec3 p) {
  if (distance.kind == AxisKind::linear) return Answer::unknown;
  const double q = norm(p);
  if (!distance.holds(q)) return Answer::outside;
  const Vec3 d = distance.direction, axis = inner.direction;
  // R_outer^-1 p = q R_inner d has the same part along the inner axis as q d.
  const auto angles = solve_turn(outer.direction, p, axis, q * dot(d, axis));
  return known(std::ranges::any_of(angles, [&](double angle) {
    return outer.holds_angle(angle) && inner.holds_angle(angle_between(axis, d, turned_back(outer, angle, p)));
  }));
}

}  // namespace

Answer answer_at(const eval::VolumeElementShape& element, Vec3 p) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, {}, [&](std::size_t i) { return element.axes[i]; });
  std::vector<Range> lengths, turns;
  for (const std::size_t i : order) {
    const eval::CoordinateAxis& axis = element.system->axes()[element.axes[i]];
    if (axis.kind == AxisKind::scalar) return Answer::unknown;
    (axis.kind == AxisKind::circular ? turns : lengths)
        .push_back({axis.kind, axis.direction, element.from[i], element.to[i]});
  }
  const Vec3 local = inverse(element.system->world_from_system()) * p;
  switch (turns.size()) {
    case 0:
      return straight(lengths, local);
    case 1:
      return turned_once(turns[0], lengths, local);
    case 2:
      return turned_twice(turns[0], turns[1], lengths[0], local);
    default:
      return Answer::unknown;
  }
}

}  // namespace meso::membership
