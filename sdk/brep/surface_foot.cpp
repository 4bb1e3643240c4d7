// SPDX-License-Identifier: Apache-2.0
#include "surface_foot.hpp"

#include <ShapeAnalysis_Surface.hxx>

#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr double search_tolerance = 1e-9;

/// A point by its height over a frame's plane and its distance from the axis; `outwards` is a unit vector.
struct ByAxis {
  double height = 0, distance = 0;
  Vec3 outwards;

  ByAxis(const AxisFrame& frame, Vec3 p) : height(dot(p - frame.origin, frame.z)) {
    const Vec3 across = p - frame.origin - height * frame.z;
    distance = norm(across);
    outwards = distance > 0 ? across / distance : frame.x;
  }
  [[nodiscard]] Vec3 at(const AxisFrame& frame, double d, double h) const {
    return frame.origin + d * outwards + h * frame.z;
  }
};

Vec3 foot(const Plane& s, Vec3 p) { return p - dot(p - s.frame.origin, s.frame.z) * s.frame.z; }
Vec3 foot(const CylinderSurface& s, Vec3 p) {
  const ByAxis q(s.frame, p);
  return q.at(s.frame, s.radius, q.height);
}
Vec3 foot(const ConeSurface& s, Vec3 p) {
  const ByAxis q(s.frame, p);
  const double sine = std::sin(s.half_angle), cosine = std::cos(s.half_angle);
  const double along = (q.distance - s.radius) * sine + q.height * cosine;
  return q.at(s.frame, s.radius + along * sine, along * cosine);
}
Vec3 foot(const SphereSurface& s, Vec3 p) {
  const Vec3 from_centre = p - s.frame.origin;
  const double distance = norm(from_centre);
  return s.frame.origin + (s.radius / distance) * from_centre;
}
Vec3 foot(const TorusSurface& s, Vec3 p) {
  const ByAxis q(s.frame, p);
  const double across = q.distance - s.major_radius, from_tube = std::hypot(across, q.height);
  const double scale = s.minor_radius / from_tube;
  return q.at(s.frame, s.major_radius + scale * across, scale * q.height);
}
Vec3 foot(const BSplineSurface&, Vec3 p) { return p; }  // searched for

}  // namespace

SurfaceFoot::SurfaceFoot(const Surface& surface) : surface_(surface) {
  if (std::holds_alternative<BSplineSurface>(surface)) search_ = new ShapeAnalysis_Surface(to_geom(surface));
}

Vec3 SurfaceFoot::operator()(Vec3 p) {
  if (search_.IsNull()) return std::visit([&](const auto& s) { return foot(s, p); }, surface_);
  last_ = has_last_ ? search_->NextValueOfUV(last_, to_pnt(p), search_tolerance)
                    : search_->ValueOfUV(to_pnt(p), search_tolerance);
  has_last_ = true;
  return to_vec(search_->Value(last_));
}

}  // namespace meso::brep
