// SPDX-License-Identifier: Apache-2.0
// The inverse of P: closed forms for straight, cylindrical and spherical systems, oblique ones included.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "field_source.hpp"
#include "orientation.hpp"

namespace meso::eval {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;
constexpr double parallel_tolerance = 1e-9;
constexpr double range_tolerance = 1e-9;

using Ranges = std::span<const std::array<double, 2>>;

/// The turn of an angle that lies in the range, or as near to it as can be.
double turned_into(double angle, const std::array<double, 2>& range) {
  const double first = angle + full_turn * std::ceil((range[0] - range_tolerance - angle) / full_turn);
  if (first <= range[1] + range_tolerance) return first;
  return first - range[1] < range[0] - (first - full_turn) ? first : first - full_turn;
}

double distance_from(double q, const std::array<double, 2>& range) {
  return std::max({0.0, range[0] - q, q - range[1]});
}

/// The angle about `axis`, right-handed, from a to b as seen along it.
double angle_about(Vec3 axis, Vec3 a, Vec3 b) {
  const Vec3 from = a - dot(a, axis) * axis, to = b - dot(b, axis) * axis;
  return std::atan2(dot(axis, cross(from, to)), dot(from, to));
}

/// Coordinates q with the least |sum q e - p|.
std::vector<double> on_straight_axes(const std::vector<CoordinateAxis>& axes, Vec3 p) {
  if (axes.size() == 3) {
    const Vec3 q = solve(Mat3::from_columns(axes[0].direction, axes[1].direction, axes[2].direction), p);
    return {q.x, q.y, q.z};
  }
  const Vec3 a = axes[0].direction;
  if (axes.size() == 1) return {dot(a, p) / dot(a, a)};
  const Vec3 b = axes[1].direction;
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), pa = dot(p, a), pb = dot(p, b);
  const double d = aa * bb - ab * ab;
  return {(pa * bb - pb * ab) / d, (pb * aa - pa * ab) / d};
}

struct Kinds {
  std::vector<std::size_t> linear, distance, circular;
};
Kinds kinds_of(const std::vector<CoordinateAxis>& axes) {
  Kinds kinds;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].kind == AxisKind::linear) kinds.linear.push_back(i);
    if (axes[i].kind == AxisKind::distance) kinds.distance.push_back(i);
    if (axes[i].kind == AxisKind::circular) kinds.circular.push_back(i);
  }
  return kinds;
}

std::optional<std::vector<double>> cylindrical(const std::vector<CoordinateAxis>& axes, const Kinds& kinds, Vec3 p,
                                               Ranges ranges) {
  const std::size_t c = kinds.circular[0], d = kinds.distance[0];
  const Vec3 axis = axes[c].direction, ray = axes[d].direction;
  const Vec3 ray_aside = ray - dot(ray, axis) * axis, p_aside = p - dot(p, axis) * axis;
  if (norm(ray_aside) < parallel_tolerance) return std::nullopt;
  std::vector<double> q(axes.size(), 0);
  q[d] = norm(p_aside) / norm(ray_aside);
  q[c] = turned_into(angle_about(axis, ray, p), ranges[c]);
  if (kinds.linear.empty()) return q;
  const std::size_t l = kinds.linear[0];
  const Vec3 along = axes[l].direction;
  if (norm(cross(along, axis)) > parallel_tolerance) return std::nullopt;
  q[l] = (dot(p, axis) - q[d] * dot(ray, axis)) / dot(along, axis);
  return q;
}

// With u = p/|p| and R1(a) R2(b) d = u: the part of R2(b) d along the first axis is that of u, which gives two b; then
// a.
std::optional<std::vector<double>> spherical(const std::vector<CoordinateAxis>& axes, const Kinds& kinds, Vec3 p,
                                             Ranges ranges) {
  const std::size_t o = kinds.circular[0], i = kinds.circular[1], d = kinds.distance[0];
  const Vec3 outer = axes[o].direction, inner = axes[i].direction, ray = axes[d].direction;
  const double r = norm(p);
  const Vec3 u = r > 0 ? p / r : ray;
  const Vec3 ray_along = dot(ray, inner) * inner, ray_aside = ray - ray_along;
  const double a = dot(outer, ray_aside), b = dot(outer, cross(inner, ray_aside)), size = std::hypot(a, b);
  if (size < parallel_tolerance) return std::nullopt;
  const double middle = std::atan2(b, a);
  const double half = std::acos(std::clamp((dot(outer, u) - dot(outer, ray_along)) / size, -1.0, 1.0));
  std::optional<std::vector<double>> best;
  double best_distance = HUGE_VAL;
  for (const double angle : {middle + half, middle - half}) {
    std::vector<double> q(axes.size(), 0);
    q[d] = r;
    q[i] = turned_into(angle, ranges[i]);
    const Vec3 seen = rotation(inner, q[i]) * ray;
    q[o] = turned_into(angle_about(outer, seen, u), ranges[o]);
    const double away = distance_from(q[i], ranges[i]) + distance_from(q[o], ranges[o]);
    if (away < best_distance) {
      best_distance = away;
      best = std::move(q);
    }
  }
  return best;
}

}  // namespace

std::optional<std::vector<double>> coordinates_at(const CoordinateFrame& frame, Vec3 global, Ranges ranges) {
  const std::vector<CoordinateAxis>& axes = frame.axes();
  const Affine& world = frame.world_from_system();
  const Vec3 p = transposed(world.linear) * (global - world.translation);  // rigid
  const Kinds kinds = kinds_of(axes);
  const std::size_t spatial = kinds.linear.size() + kinds.distance.size() + kinds.circular.size();
  if (spatial != axes.size() || spatial == 0 || spatial > 3) return std::nullopt;
  if (kinds.circular.empty()) return on_straight_axes(axes, p);
  if (kinds.distance.size() != 1) return std::nullopt;
  if (kinds.circular.size() == 1 && kinds.linear.size() <= 1) return cylindrical(axes, kinds, p, ranges);
  if (kinds.circular.size() == 2) return spherical(axes, kinds, p, ranges);
  return std::nullopt;
}

}  // namespace meso::eval
