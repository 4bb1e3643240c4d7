// SPDX-License-Identifier: Apache-2.0
#pragma once
// What placed cells come down to: struts and balls by the million, and whole fields. Private.

#include <memory>

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

/// A body given by a field of its own, placed; its values in the world are factor * field(local p).
struct PlacedField {
  std::shared_ptr<const FlatTerm> field;
  Affine local_from_world;
  double factor = 1;
  double lipschitz = 1;  ///< of its values in the world

  [[nodiscard]] double value(Vec3 p) const { return factor * field->value(local_from_world * p); }
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
