// SPDX-License-Identifier: Apache-2.0
#pragma once
// A curve that two surfaces share, laid through points that are on both. Private.
//
// OpenCASCADE walks along the intersection of two surfaces and lays a curve through what it met: on B-spline surfaces
// that curve is off by up to a hundredth of the cell. Here its points are moved onto both surfaces by Newton's method,
// and a spline of degree 7 is laid through them, with its images in both parameter planes.
//
// Cost: about 0.2 ms for each curve on quadrics, 1 ms on B-spline surfaces.

#include <Geom2d_BSplineCurve.hxx>
#include <optional>

#include "occt.hpp"

namespace meso::brep {

constexpr double curve_aim = 1e-7;       ///< of the cell: how far a curve may be off
constexpr double curve_farthest = 2e-2;  ///< of the cell: how far a point may move
constexpr double curve_flattest = 1e-3;  ///< sine of the angle between surfaces that cut each other

/// A point of a surface that follows a point of space.
class Foot {
 public:
  Foot(const GeomAdaptor_Surface& surface, const gp_Pnt2d& at) : surface_(surface), u_(at.X()), v_(at.Y()) { look(); }

  [[nodiscard]] Vec3 point() const { return point_; }
  [[nodiscard]] Vec3 normal() const { return normal_; }
  [[nodiscard]] gp_Pnt2d parameters() const { return {u_, v_}; }
  /// Where the surface has a tangent plane.
  [[nodiscard]] bool regular() const { return regular_; }

  /// One step of Gauss and Newton.
  void follow(Vec3 p);

 private:
  void look();

  const GeomAdaptor_Surface& surface_;
  double u_, v_;
  Vec3 point_, du_, dv_, normal_;
  bool regular_ = false;
};

/// Onto the surface, as close to `p` as it gets.
[[nodiscard]] bool drop(Foot& foot, Vec3 p, double eps);

/// To the nearest point of both surfaces.
[[nodiscard]] std::optional<Vec3> meet(Foot& a, Foot& b, Vec3 p, double eps);

/// A curve that is nearly on two surfaces, with its images at the same parameters.
struct SharedCurve {
  GeomAdaptor_Surface a, b;
  Handle(Geom_Curve) curve;
  Handle(Geom2d_Curve) on_a, on_b;
  double first = 0, last = 0;

  [[nodiscard]] double at(int i, int count) const { return first + (last - first) * i / (count - 1); }
};

/// The curve and its images, through the same points at the same parameters.
struct FittedCurve {
  Handle(Geom_BSplineCurve) curve;
  Handle(Geom2d_BSplineCurve) on_a, on_b;
  double off = 0;  ///< from the surfaces at most
};

/// From `start` to `end`, which are on both; of the cell's `size`. Empty where the surfaces nearly touch.
[[nodiscard]] std::optional<FittedCurve> fit_curve(const SharedCurve& on, Vec3 start, Vec3 end, double size);

}  // namespace meso::brep
