// SPDX-License-Identifier: Apache-2.0
#include "value_geometry.hpp"

#include <ElCLib.hxx>
#include <numbers>

namespace meso::brep {
namespace {

gp_Ax2 to_ax2(const AxisFrame& f) { return {to_pnt(f.origin), to_dir(f.z), to_dir(f.x)}; }
gp_Ax3 to_ax3(const AxisFrame& f) { return {to_pnt(f.origin), to_dir(f.z), to_dir(f.x)}; }

Handle(Geom_Surface) make(const Plane& s) { return new Geom_Plane(to_ax3(s.frame)); }
Handle(Geom_Surface) make(const CylinderSurface& s) { return new Geom_CylindricalSurface(to_ax3(s.frame), s.radius); }
Handle(Geom_Surface) make(const ConeSurface& s) {
  return new Geom_ConicalSurface(to_ax3(s.frame), s.half_angle, s.radius);
}
Handle(Geom_Surface) make(const SphereSurface& s) { return new Geom_SphericalSurface(to_ax3(s.frame), s.radius); }
Handle(Geom_Surface) make(const TorusSurface& s) {
  return new Geom_ToroidalSurface(to_ax3(s.frame), s.major_radius, s.minor_radius);
}
Handle(Geom_Curve) make(const Line& c) { return new Geom_Line(to_pnt(c.origin), to_dir(c.direction)); }
Handle(Geom_Curve) make(const Circle& c) { return new Geom_Circle(to_ax2(c.frame), c.radius); }
Handle(Geom_Curve) make(const Ellipse& c) { return new Geom_Ellipse(to_ax2(c.frame), c.major_radius, c.minor_radius); }

TColStd_Array1OfReal to_array(const std::vector<double>& values) {
  TColStd_Array1OfReal array(1, static_cast<int>(values.size()));
  for (int i = 1; i <= array.Length(); ++i) array(i) = values[static_cast<std::size_t>(i - 1)];
  return array;
}
TColStd_Array1OfInteger to_array(const std::vector<int>& values) {
  TColStd_Array1OfInteger array(1, static_cast<int>(values.size()));
  for (int i = 1; i <= array.Length(); ++i) array(i) = values[static_cast<std::size_t>(i - 1)];
  return array;
}

Handle(Geom_Surface) make(const BSplineSurface& s) {
  const int rows = static_cast<int>(s.u_count), columns = static_cast<int>(s.v_count);
  TColgp_Array2OfPnt poles(1, rows, 1, columns);
  TColStd_Array2OfReal weights(1, rows, 1, columns);
  std::size_t next = 0;
  for (int i = 1; i <= rows; ++i)
    for (int j = 1; j <= columns; ++j, ++next) {
      poles(i, j) = to_pnt(s.poles[next]);
      weights(i, j) = s.weights.empty() ? 1 : s.weights[next];
    }
  return new Geom_BSplineSurface(poles, weights, to_array(s.u_knots), to_array(s.v_knots), to_array(s.u_multiplicities),
                                 to_array(s.v_multiplicities), s.u_degree, s.v_degree);
}

Handle(Geom_Curve) make(const BSplineCurve& c) {
  const int count = static_cast<int>(c.poles.size());
  TColgp_Array1OfPnt poles(1, count);
  TColStd_Array1OfReal weights(1, count);
  for (int i = 1; i <= count; ++i) {
    const auto k = static_cast<std::size_t>(i - 1);
    poles(i) = to_pnt(c.poles[k]);
    weights(i) = c.weights.empty() ? 1 : c.weights[k];
  }
  return new Geom_BSplineCurve(poles, weights, to_array(c.knots), to_array(c.multiplicities), c.degree);
}

CurveRange around(double first, double last, bool closed) {
  constexpr double turn = 2 * std::numbers::pi;
  if (closed) return {first, first + turn};
  return {first, last > first ? last : last + turn};
}

CurveRange range(const Line& c, Vec3 from, Vec3 to, bool) {
  return {dot(from - c.origin, c.direction), dot(to - c.origin, c.direction)};
}
CurveRange range(const Circle& c, Vec3 from, Vec3 to, bool closed) {
  const gp_Circ circle(to_ax2(c.frame), c.radius);
  return around(ElCLib::Parameter(circle, to_pnt(from)), ElCLib::Parameter(circle, to_pnt(to)), closed);
}
CurveRange range(const Ellipse& c, Vec3 from, Vec3 to, bool closed) {
  const gp_Elips ellipse(to_ax2(c.frame), c.major_radius, c.minor_radius);
  return around(ElCLib::Parameter(ellipse, to_pnt(from)), ElCLib::Parameter(ellipse, to_pnt(to)), closed);
}
CurveRange range(const BSplineCurve& c, Vec3, Vec3, bool) { return {c.knots.front(), c.knots.back()}; }

}  // namespace

Handle(Geom_Surface) to_geom(const Surface& surface) {
  return std::visit([](const auto& s) { return make(s); }, surface);
}
Handle(Geom_Curve) to_geom(const Curve& curve) {
  return std::visit([](const auto& c) { return make(c); }, curve);
}
CurveRange range_between(const Curve& curve, Vec3 from, Vec3 to, bool closed) {
  return std::visit([&](const auto& c) { return range(c, from, to, closed); }, curve);
}

}  // namespace meso::brep
