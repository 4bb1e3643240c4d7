// SPDX-License-Identifier: Apache-2.0
#include "lattice/primitive_field.hpp"

#include <algorithm>

namespace meso::brep {
namespace {

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
  const double flank = std::hypot(t - s * length, r - frustum.start_radius - s * slope);
  const double to_start = std::hypot(t, std::max(0.0, r - frustum.start_radius));
  const double to_end = std::hypot(t - length, std::max(0.0, r - frustum.end_radius));
  const double nearest = std::min({flank, to_start, to_end});
  const bool inside = t > 0 && t < length && r < frustum.start_radius + slope * t / length;
  return inside ? -nearest : nearest;
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
    const Vec3 quarter = half / 2;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 shift{corner & 1 ? quarter.x : -quarter.x, corner & 2 ? quarter.y : -quarter.y,
                       corner & 4 ? quarter.z : -quarter.z};
      if (!covered_in(centre + shift, quarter)) return false;
    }
    return true;
  }
};

/// The common case, decided without a search that would follow two equal surfaces everywhere.
bool within(const CellPrimitive& inner, const CellPrimitive& outer, double tolerance) {
  if (const auto* ball = std::get_if<Ball>(&inner))
    return signed_distance(outer, ball->centre) <= tolerance - ball->radius;
  const auto* a = std::get_if<Frustum>(&inner);
  const auto* b = std::get_if<Frustum>(&outer);
  if (!b) return false;
  const auto same = [&](Vec3 start, Vec3 end, double start_radius, double end_radius) {
    return norm(a->start - start) <= tolerance && norm(a->end - end) <= tolerance &&
           a->start_radius <= start_radius + tolerance && a->end_radius <= end_radius + tolerance;
  };
  return same(b->start, b->end, b->start_radius, b->end_radius) ||
         same(b->end, b->start, b->end_radius, b->start_radius);
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

bool covered(const CellPrimitive& primitive, std::span<const CellPrimitive> others, const Box3& box) {
  const Vec3 size = box.max - box.min;
  const double tolerance = 1e-9 * norm(size);
  for (const CellPrimitive& other : others)
    if (within(primitive, other, tolerance)) return true;
  Box3 part = bounds(primitive);  // the search need not look beyond it
  if (!part.intersects(box)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    part.min[i] = std::max(part.min[i], box.min[i]);
    part.max[i] = std::min(part.max[i], box.max[i]);
  }
  CoverSearch search{primitive, others, 1e-4 * norm(size)};
  return search.covered_in(0.5 * (part.min + part.max), 0.5 * (part.max - part.min));
}

double sampled_volume(std::span<const CellPrimitive> primitives, const Box3& box) {
  constexpr int count = 48;
  const Vec3 step = (box.max - box.min) / count;
  const double width = norm(step) / std::sqrt(3.0);
  double filled = 0;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < count; ++k) {
        const Vec3 p = box.min + Vec3{(i + 0.5) * step.x, (j + 0.5) * step.y, (k + 0.5) * step.z};
        // A voxel that the surface crosses counts by its distance, not as all or nothing.
        filled += std::clamp(0.5 - signed_distance(primitives, p) / width, 0.0, 1.0);
      }
  return filled * step.x * step.y * step.z;
}

}  // namespace meso::brep
