// SPDX-License-Identifier: Apache-2.0
#include "lattice/primitive_field.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "beam_graph_joints.hpp"

namespace meso::brep {
namespace {

// std::hypot minds overflow, at ten times the cost.
double length_of(double a, double b) { return std::sqrt(a * a + b * b); }

double distance_to(const Ball& ball, Vec3 p) { return norm(p - ball.centre) - ball.radius; }

/// In the half plane (t along the axis, r from it) the frustum is a trapezium: distance to its two ends and its flank.
double distance_to(const Frustum& frustum, Vec3 p) {
  const double length = norm(frustum.end - frustum.start);
  const Vec3 axis = (frustum.end - frustum.start) / length;
  const double t = dot(p - frustum.start, axis);
  const double r = norm(p - frustum.start - t * axis);
  const double slope = frustum.end_radius - frustum.start_radius;
  const double s =
      std::clamp((t * length + (r - frustum.start_radius) * slope) / (length * length + slope * slope), 0.0,
                 1.0);  // foot of the perpendicular on the flank
  const double flank = length_of(t - s * length, r - frustum.start_radius - s * slope);
  const double to_start = length_of(t, std::max(0.0, r - frustum.start_radius));
  const double to_end = length_of(t - length, std::max(0.0, r - frustum.end_radius));
  const double nearest = std::min({flank, to_start, to_end});
  const bool inside = t > 0 && t < length && r < frustum.start_radius + slope * t / length;
  return inside ? -nearest : nearest;
}

/// From the centre of a box to that of one of its eight halves.
Vec3 octant(Vec3 half, int corner) {
  const Vec3 quarter = half / 2;
  return {corner & 1 ? quarter.x : -quarter.x, corner & 2 ? quarter.y : -quarter.y,
          corner & 4 ? quarter.z : -quarter.z};
}

struct CoverSearch {
  const CellPrimitive& primitive;
  std::span<const CellPrimitive> others;
  double smallest;
  int budget = 400'000;

  bool covered_in(Vec3 centre, Vec3 half) {
    if (--budget < 0) return false;
    const double reach = norm(half);
    const double own = signed_distance(primitive, centre);
    if (own >= reach) return true;
    const double other = signed_distance(others, centre);
    if (other <= -reach) return true;
    if (own < -smallest && other > smallest) return false;
    if (reach < smallest) return true;
    for (int corner = 0; corner < 8; ++corner)
      if (!covered_in(centre + octant(half, corner), half / 2)) return false;
    return true;
  }
};

/// What is about the same centre or axis decides at once; empty if nothing is.
std::optional<bool> covered_by_like(const CellPrimitive& primitive, std::span<const CellPrimitive> others,
                                    double tolerance) {
  std::optional<bool> found;
  for (const CellPrimitive& other : others) {
    if (primitive.index() != other.index()) continue;
    if (const Ball* ball = std::get_if<Ball>(&primitive)) {
      const Ball& like = std::get<Ball>(other);
      const double apart = norm(like.centre - ball->centre);
      if (apart + ball->radius <= like.radius) return true;
      if (apart <= tolerance) found = false;
      continue;
    }
    const Frustum &strut = std::get<Frustum>(primitive), &like = std::get<Frustum>(other);
    for (const bool turned : {false, true}) {
      if (norm(strut.start - (turned ? like.end : like.start)) > tolerance ||
          norm(strut.end - (turned ? like.start : like.end)) > tolerance)
        continue;
      if (strut.start_radius <= (turned ? like.end_radius : like.start_radius) &&
          strut.end_radius <= (turned ? like.start_radius : like.end_radius))
        return true;
      found = false;
    }
  }
  return found;
}

/// How far the circle in which a strut leaves a ball about its end reaches into the box, side by side; empty if there
/// is no such ball.
std::optional<std::array<double, 6>> depths_of_circle(const Frustum& strut, bool at_end,
                                                      std::span<const CellPrimitive> others, const Box3& box) {
  const Vec3 centre = at_end ? strut.end : strut.start,
             away = at_end ? strut.start - strut.end : strut.end - strut.start;
  const double radius = at_end ? strut.end_radius : strut.start_radius, length = norm(away);
  const double growth =
      (at_end ? strut.start_radius - strut.end_radius : strut.end_radius - strut.start_radius) / length;
  double ball = 0;
  for (const CellPrimitive& other : others)
    if (const Ball* about = std::get_if<Ball>(&other);
        about != nullptr && norm(about->centre - centre) <= 1e-9 * length)
      ball = std::max(ball, about->radius);
  if (ball < radius) return {};
  const StrutEnd circle = leave_ball(ball, radius, growth);
  std::array<double, 6> depths{};
  for (std::size_t side = 0; side < 6; ++side) {
    const std::size_t i = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1, along = sign * away[i] / length;
    depths[side] = sign * (centre[i] - (side % 2 == 0 ? box.min : box.max)[i]) + circle.along * along +
                   circle.radius * std::sqrt(std::max(0.0, 1 - along * along));
  }
  return depths;
}

/// Between the balls about its ends, all of the strut is beyond one side of the box.
bool is_beyond_but_for_balls(const Frustum& strut, std::span<const CellPrimitive> others, const Box3& box) {
  const auto first = depths_of_circle(strut, false, others, box);
  if (!first) return false;
  const auto second = depths_of_circle(strut, true, others, box);
  const double touches = 1e-7 * norm(box.max - box.min);
  for (std::size_t side = 0; second && side < 6; ++side)
    if ((*first)[side] <= touches && (*second)[side] <= touches) return true;
  return false;
}

/// Halves the box until it is on one side of the surface, or `depth` times; then a flat surface, as far from its
/// centre, speaks for all of it.
double filled(std::span<const CellPrimitive> primitives, Vec3 centre, Vec3 half, int depth) {
  const double distance = signed_distance(primitives, centre);
  const double box = 8 * half.x * half.y * half.z;
  if (std::fabs(distance) >= norm(half)) return distance < 0 ? box : 0;
  if (depth == 0) return box * std::clamp(0.5 - distance / (2 * std::cbrt(box / 8)), 0.0, 1.0);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner)
    sum += filled(primitives, centre + octant(half, corner), half / 2, depth - 1);
  return sum;
}

}  // namespace

double signed_distance(const CellPrimitive& primitive, Vec3 p) {
  return std::visit([&](const auto& shape) { return distance_to(shape, p); }, primitive);
}

double signed_distance(std::span<const CellPrimitive> primitives, Vec3 p) {
  double nearest = HUGE_VAL;
  for (const CellPrimitive& primitive : primitives) nearest = std::min(nearest, signed_distance(primitive, p));
  return nearest;
}

Box3 bounds(const CellPrimitive& primitive) {
  Box3 box;
  if (const auto* ball = std::get_if<Ball>(&primitive)) {
    const Vec3 r{ball->radius, ball->radius, ball->radius};
    box.extend(ball->centre - r);
    box.extend(ball->centre + r);
    return box;
  }
  const auto& frustum = std::get<Frustum>(primitive);
  const Vec3 axis = (frustum.end - frustum.start) / norm(frustum.end - frustum.start);
  const auto extend_by_disc = [&](Vec3 centre, double radius) {
    Vec3 reach;
    for (std::size_t i = 0; i < 3; ++i) reach[i] = radius * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    box.extend(centre - reach);
    box.extend(centre + reach);
  };
  extend_by_disc(frustum.start, frustum.start_radius);
  extend_by_disc(frustum.end, frustum.end_radius);
  return box;
}

CellPrimitive translated(const CellPrimitive& primitive, Vec3 by) {
  CellPrimitive moved = primitive;
  if (auto* ball = std::get_if<Ball>(&moved)) {
    ball->centre += by;
  } else {
    auto& frustum = std::get<Frustum>(moved);
    frustum.start += by;
    frustum.end += by;
  }
  return moved;
}

bool same(const CellPrimitive& a, const CellPrimitive& b, double tolerance) {
  if (a.index() != b.index()) return false;
  if (const auto* ball = std::get_if<Ball>(&a)) {
    const auto& other = std::get<Ball>(b);
    return norm(ball->centre - other.centre) <= tolerance && std::fabs(ball->radius - other.radius) <= tolerance;
  }
  const auto& strut = std::get<Frustum>(a);
  const auto runs = [&](Vec3 start, Vec3 end, double start_radius, double end_radius) {
    return norm(strut.start - start) <= tolerance && norm(strut.end - end) <= tolerance &&
           std::fabs(strut.start_radius - start_radius) <= tolerance &&
           std::fabs(strut.end_radius - end_radius) <= tolerance;
  };
  const auto& other = std::get<Frustum>(b);
  return runs(other.start, other.end, other.start_radius, other.end_radius) ||
         runs(other.end, other.start, other.end_radius, other.start_radius);
}

bool covered(const CellPrimitive& primitive, std::span<const CellPrimitive> others, const Box3& box) {
  const Vec3 size = box.max - box.min;
  // Decided without a search that would follow two equal surfaces everywhere.
  for (const CellPrimitive& other : others)
    if (same(primitive, other, 1e-9 * norm(size))) return true;
  // Or that would follow the points in which a strut touches a side of the box.
  if (const auto decided = covered_by_like(primitive, others, 1e-9 * norm(size))) return *decided;
  if (const Frustum* strut = std::get_if<Frustum>(&primitive);
      strut != nullptr && is_beyond_but_for_balls(*strut, others, box))
    return true;
  Box3 part = bounds(primitive);  // the search need not look beyond it
  if (!part.intersects(box)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    part.min[i] = std::max(part.min[i], box.min[i]);
    part.max[i] = std::min(part.max[i], box.max[i]);
  }
  CoverSearch search{primitive, others, 1e-4 * norm(size)};
  return search.covered_in(0.5 * (part.min + part.max), 0.5 * (part.max - part.min));
}

double sampled_volume(std::span<const CellPrimitive> primitives, const Box3& box, int depth) {
  return filled(primitives, 0.5 * (box.min + box.max), 0.5 * (box.max - box.min), depth);
}

}  // namespace meso::brep
