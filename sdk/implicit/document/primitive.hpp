// SPDX-License-Identifier: Apache-2.0
#pragma once
// What placed cells come down to: struts and balls by the million, and whole fields. Private.

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "meso/base/vec.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {

/// All points within `radius` of the segment from + [0, 1] axis; a ball where the axis is zero. Its distance is exact.
struct Capsule {
  Vec3 from, axis;
  double inverse_length2 = 0;  ///< 1 / |axis|^2; 0 for a ball
  double radius = 0;
  friend bool operator==(const Capsule&, const Capsule&) = default;
};

[[nodiscard]] inline Capsule capsule(Vec3 from, Vec3 to, double radius) {
  const Vec3 axis = to - from;
  const double length2 = dot(axis, axis);
  return {from, axis, length2 > 0 ? 1 / length2 : 0, radius};
}

/// Distance from the capsule's segment.
[[nodiscard]] inline double axis_distance(const Capsule& c, Vec3 p) {
  const Vec3 w = p - c.from;
  double t = dot(w, c.axis) * c.inverse_length2;
  t = t < 0 ? 0 : t;
  t = t > 1 ? 1 : t;
  return norm(w - t * c.axis);
}

/// A cone with flat ends about the z axis, from z = 0 to z = height; none where the height is 0.
struct Cone {
  double bottom = 0, top = 0, height = 0;
};

/// In the half plane through the axis: to the nearer end's disc, and to the side between the rims.
[[nodiscard]] inline double distance(const Cone& c, Vec3 p) {
  const double r = std::sqrt(p.x * p.x + p.y * p.y), middle = c.height / 2;
  const double beyond = std::abs(p.z - middle) - middle;
  const double beside = std::max(0.0, r - (p.z > middle ? c.top : c.bottom));
  const double grows = c.top - c.bottom;
  double t = ((r - c.bottom) * grows + p.z * c.height) / (grows * grows + c.height * c.height);
  t = t < 0 ? 0 : t;
  t = t > 1 ? 1 : t;
  const double outwards = r - c.bottom - t * grows, along = p.z - t * c.height;
  const double square = std::min(beside * beside + beyond * beyond, outwards * outwards + along * along);
  return outwards < 0 && beyond < 0 ? -std::sqrt(square) : std::sqrt(square);
}

/// A body given by a field of its own, placed; its values in the world are factor * field(local p).
struct PlacedField {
  std::shared_ptr<const FlatTerm> field;
  Affine local_from_world;
  double factor = 1;
  double lipschitz = 1;  ///< of its values in the world
  Cone cone{};           ///< what the field is, where it is one, shrunk by `grown`: known by a formula, not by steps
  double grown = 0;

  [[nodiscard]] double value(Vec3 p) const {
    const Vec3 local = local_from_world * p;
    return factor * (cone.height > 0 ? distance(cone, local) - grown : field->value(local));
  }
  /// REQUIRES: as many values as points; `local` is room for what stands between.
  void values(std::span<const Vec3> points, std::vector<Vec3>& local, double* out) const {
    if (cone.height > 0) {
      for (std::size_t n = 0; n < points.size(); ++n) out[n] = value(points[n]);
      return;
    }
    local.resize(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) local[n] = local_from_world * points[n];
    field->values(local, {out, points.size()});
    for (std::size_t n = 0; n < points.size(); ++n) out[n] *= factor;
  }
  [[nodiscard]] Interval interval(const Box3& box) const {
    Box3 local;
    for (unsigned corner = 0; corner < 8; ++corner)
      local.extend(local_from_world * Vec3{corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                           corner & 4 ? box.max.z : box.min.z});
    const Interval f = field->interval(local);
    return {factor * f.lo, factor * f.hi, f.undefined};
  }
};

/// One of the two, and a box around it.
struct Primitive {
  Capsule capsule;  ///< where `placed` holds no field
  PlacedField placed{};
  Box3 box;

  [[nodiscard]] bool is_capsule() const { return placed.field == nullptr; }
  [[nodiscard]] double value(Vec3 p) const {
    return is_capsule() ? axis_distance(capsule, p) - capsule.radius : placed.value(p);
  }
  [[nodiscard]] Primitive moved_by(Vec3 d) const {
    Primitive result = *this;
    result.capsule.from += d;
    result.placed.local_from_world.translation = placed.local_from_world * -d;
    result.box = {box.min + d, box.max + d};
    return result;
  }
};

}  // namespace meso::implicit
