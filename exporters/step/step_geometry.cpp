// SPDX-License-Identifier: Apache-2.0
#include "step_geometry.hpp"

#include <bit>
#include <cmath>

#include "meso/brep/placement.hpp"

namespace meso::step {

using namespace brep;

Pose::Pose(const Shell& shell)
    : geometry_(*shell.geometry), placement_(shell.placement), scale_(std::cbrt(determinant(shell.placement.linear))) {
  if (scale_ == 1 || std::abs(scale_ - 1) < 1e-12) scale_ = 1;  // rounding of a rotation is not a scale
  rotation_ = placement_.linear;
  for (double& m : rotation_.m) m /= scale_;
}

void Pose::set_cell(const Index3& cell) { cell_origin_ = brep::cell_origin(geometry_, cell); }

std::size_t Directions::Hash::operator()(const Vec3& v) const {
  std::uint64_t h = 0;
  for (const double c : {v.x, v.y, v.z}) h = std::rotl((h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u, 29);
  return h;
}

const Directions::Ids* Directions::find(Vec3 unit) const {
  const auto known = ids_.find(unit + Vec3{0, 0, 0});  // -0 and 0 are one direction
  return known == ids_.end() ? nullptr : &known->second;
}

Directions::Ids* Directions::find_or_add(Vec3 unit) {
  constexpr std::size_t most = 200'000;
  if (ids_.size() < most) return &ids_[unit + Vec3{0, 0, 0}];
  const auto known = ids_.find(unit + Vec3{0, 0, 0});
  return known == ids_.end() ? nullptr : &known->second;
}

/// The number of an entity along `unit`, written when it is first used.
template <typename Write>
StepId StepGeometry::once(Vec3 unit, StepId Directions::Ids::*id, Write write) {
  if (growing_ != nullptr) {
    Directions::Ids* const ids = growing_->find_or_add(unit);
    if (ids == nullptr) return write();
    if (ids->*id == 0) {
      const StepId written = write();  // may move what `ids` points to
      growing_->find_or_add(unit)->*id = written;
      return written;
    }
    return ids->*id;
  }
  const Directions::Ids* const ids = known_.find(unit);
  return ids == nullptr || ids->*id > text_.last() ? write() : ids->*id;
}

StepId StepGeometry::direction(Vec3 unit) {
  return once(unit, &Directions::Ids::direction, [&] { return text_.entity("DIRECTION", NoName{}, unit); });
}

StepId StepGeometry::vector(Vec3 unit) {
  const StepId along = direction(unit);
  return once(unit, &Directions::Ids::vector, [&] { return text_.entity("VECTOR", NoName{}, Ref{along}, 1.0); });
}

StepId StepGeometry::frame(const AxisFrame& frame, const Pose& pose) {
  const StepId origin = point(pose.point(frame.origin));
  const StepId z = direction(pose.direction(frame.z)), x = direction(pose.direction(frame.x));
  return text_.entity("AXIS2_PLACEMENT_3D", NoName{}, Ref{origin}, Ref{z}, Ref{x});
}

std::vector<StepId> StepGeometry::points(const std::vector<Vec3>& poles, const Pose& pose) {
  std::vector<StepId> ids;
  ids.reserve(poles.size());
  for (const Vec3& pole : poles) ids.push_back(point(pose.point(pole)));
  return ids;
}

StepId StepGeometry::surface(const Surface& surface, const Pose& pose) {
  return std::visit([&](const auto& s) { return write(s, pose); }, surface);
}

StepId StepGeometry::curve(const Curve& curve, const Pose& pose) {
  return std::visit([&](const auto& c) { return write(c, pose); }, curve);
}

StepId StepGeometry::write(const Plane& s, const Pose& pose) {
  const StepId axes = frame(s.frame, pose);
  return text_.entity("PLANE", NoName{}, Ref{axes});
}
StepId StepGeometry::write(const CylinderSurface& s, const Pose& pose) {
  const StepId axes = frame(s.frame, pose);
  return text_.entity("CYLINDRICAL_SURFACE", NoName{}, Ref{axes}, pose.length(s.radius));
}
StepId StepGeometry::write(const ConeSurface& s, const Pose& pose) {
  const StepId axes = frame(s.frame, pose);
  return text_.entity("CONICAL_SURFACE", NoName{}, Ref{axes}, pose.length(s.radius), s.half_angle);
}
StepId StepGeometry::write(const SphereSurface& s, const Pose& pose) {
  const StepId axes = frame(s.frame, pose);
  return text_.entity("SPHERICAL_SURFACE", NoName{}, Ref{axes}, pose.length(s.radius));
}
StepId StepGeometry::write(const TorusSurface& s, const Pose& pose) {
  const StepId axes = frame(s.frame, pose);
  return text_.entity("TOROIDAL_SURFACE", NoName{}, Ref{axes}, pose.length(s.major_radius),
                      pose.length(s.minor_radius));
}
StepId StepGeometry::write(const BSplineSurface& s, const Pose& pose) {
  const std::vector<StepId> ids = points(s.poles, pose);
  const Grid poles{.refs = ids, .reals = {}, .columns = s.v_count};
  const Raw form{".UNSPECIFIED."};
  if (s.weights.empty())
    return text_.entity("B_SPLINE_SURFACE_WITH_KNOTS", NoName{}, s.u_degree, s.v_degree, poles, form, s.u_closed,
                        s.v_closed, false, s.u_multiplicities, s.v_multiplicities, s.u_knots, s.v_knots, form);
  text_.begin_complex();
  text_.part("BOUNDED_SURFACE");
  text_.part("B_SPLINE_SURFACE", s.u_degree, s.v_degree, poles, form, s.u_closed, s.v_closed, false);
  text_.part("B_SPLINE_SURFACE_WITH_KNOTS", s.u_multiplicities, s.v_multiplicities, s.u_knots, s.v_knots, form);
  text_.part("GEOMETRIC_REPRESENTATION_ITEM");
  text_.part("RATIONAL_B_SPLINE_SURFACE", Grid{.refs = {}, .reals = s.weights, .columns = s.v_count});
  text_.part("REPRESENTATION_ITEM", NoName{});
  text_.part("SURFACE");
  return text_.end_complex();
}

StepId StepGeometry::write(const Line& c, const Pose& pose) {
  const StepId origin = point(pose.point(c.origin)), along = vector(pose.direction(c.direction));
  return text_.entity("LINE", NoName{}, Ref{origin}, Ref{along});
}
StepId StepGeometry::write(const Circle& c, const Pose& pose) {
  const StepId axes = frame(c.frame, pose);
  return text_.entity("CIRCLE", NoName{}, Ref{axes}, pose.length(c.radius));
}
StepId StepGeometry::write(const Ellipse& c, const Pose& pose) {
  const StepId axes = frame(c.frame, pose);
  return text_.entity("ELLIPSE", NoName{}, Ref{axes}, pose.length(c.major_radius), pose.length(c.minor_radius));
}
StepId StepGeometry::write(const BSplineCurve& c, const Pose& pose) {
  const std::vector<StepId> poles = points(c.poles, pose);
  const Raw form{".UNSPECIFIED."};
  if (c.weights.empty())
    return text_.entity("B_SPLINE_CURVE_WITH_KNOTS", NoName{}, c.degree, poles, form, c.closed, false, c.multiplicities,
                        c.knots, form);
  text_.begin_complex();
  text_.part("BOUNDED_CURVE");
  text_.part("B_SPLINE_CURVE", c.degree, poles, form, c.closed, false);
  text_.part("B_SPLINE_CURVE_WITH_KNOTS", c.multiplicities, c.knots, form);
  text_.part("CURVE");
  text_.part("GEOMETRIC_REPRESENTATION_ITEM");
  text_.part("RATIONAL_B_SPLINE_CURVE", c.weights);
  text_.part("REPRESENTATION_ITEM", NoName{});
  return text_.end_complex();
}

}  // namespace meso::step
