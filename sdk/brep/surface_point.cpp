// SPDX-License-Identifier: Apache-2.0
#include "surface_point.hpp"

#include <cmath>

namespace meso::brep {
namespace {

/// A point beside an axis: how far along, how far off, and which way.
/// A point beside an axis: how far along, how far off, and which way; on the axis along x.
struct Polar {
  double along = 0, off = 0;
  Vec3 outwards;  ///< unit
};

Polar polar_of(const AxisFrame& frame, Vec3 p) {
  const Vec3 d = p - frame.origin;
  const double along = dot(d, frame.z);
  const Vec3 across = d - along * frame.z;
  const double off = norm(across);
  return {along, off, off > 0 ? across / off : frame.x};
}

struct Nearest {
  Vec3 p;

  Vec3 operator()(const Plane& s) const { return p - dot(p - s.frame.origin, s.frame.z) * s.frame.z; }
  Vec3 operator()(const CylinderSurface& s) const {
    const Polar at = polar_of(s.frame, p);
    return p + (s.radius - at.off) * at.outwards;
  }
  Vec3 operator()(const ConeSurface& s) const {
    const Polar at = polar_of(s.frame, p);
    const double c = std::cos(s.half_angle), n = std::sin(s.half_angle);
    const double t = at.along * c + (at.off - s.radius) * n;
    if (s.radius + t * n <= 0) return s.frame.origin - s.radius * c / n * s.frame.z;  // the apex
    return s.frame.origin + t * c * s.frame.z + (s.radius + t * n) * at.outwards;
  }
  Vec3 operator()(const SphereSurface& s) const {
    const Vec3 d = p - s.frame.origin;
    const double length = norm(d);
    return s.frame.origin + s.radius * (length > 0 ? d / length : s.frame.z);
  }
  Vec3 operator()(const TorusSurface& s) const {
    const Polar at = polar_of(s.frame, p);
    const Vec3 ring = s.frame.origin + s.major_radius * at.outwards;
    const double length = norm(p - ring);
    return ring + s.minor_radius * (length > 0 ? (p - ring) / length : s.frame.z);
  }
  Vec3 operator()(const BSplineSurface&) const { return p; }
};

}  // namespace

Vec3 nearest_point(const Surface& surface, Vec3 p) { return std::visit(Nearest{p}, surface); }

}  // namespace meso::brep
