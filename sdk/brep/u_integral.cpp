// SPDX-License-Identifier: Apache-2.0
#include "u_integral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

// Where the surface stops being smooth in u: its knots, and quarter turns of the periodic ones.
std::vector<double> u_breaks(const GeomAdaptor_Surface& surface, double u_min, double u_max) {
  std::vector<double> breaks{u_min};
  const auto intervals = surface.NbUIntervals(GeomAbs_CN);
  TColStd_Array1OfReal knots(1, intervals + 1);
  surface.UIntervals(knots, GeomAbs_CN);
  for (const double knot : knots)
    if (knot > u_min && knot < u_max) breaks.push_back(knot);
  breaks.push_back(u_max);
  if (surface.GetType() == GeomAbs_BSplineSurface) return breaks;
  std::vector<double> fine;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const int pieces = std::max(1, static_cast<int>(std::ceil((breaks[i + 1] - breaks[i]) / (std::numbers::pi / 2))));
    for (int k = 0; k < pieces; ++k) fine.push_back(breaks[i] + (breaks[i + 1] - breaks[i]) * k / pieces);
  }
  fine.push_back(u_max);
  return fine;
}

Moments integrand(const GeomAdaptor_Surface& surface, double u, double v) {
  gp_Pnt p;
  gp_Vec du, dv;
  surface.D1(u, v, p, du, dv);
  const gp_Vec n = du.Crossed(dv);
  return {n.Magnitude(),
          p.X() * n.X(),
          p.Y() * n.Y(),
          p.Z() * n.Z(),
          n.X(),
          n.Y(),
          n.Z(),
          p.X() * p.X() / 2 * n.X(),
          p.Y() * p.Y() / 2 * n.Y(),
          p.Z() * p.Z() / 2 * n.Z()};
}

std::array<double, 3> to_array(const gp_XYZ& v) { return {v.X(), v.Y(), v.Z()}; }

/// Integrals of the powers of cos and sin over [a, b] that sum to three, from those of their harmonics: products, not
/// differences, so that narrow intervals lose no digits.
struct Turn {
  Turn(double a, double b) : width(b - a) {
    const double middle = (a + b) / 2, half = width / 2;
    const double c1 = std::cos(middle), s1 = std::sin(middle), d1 = std::sin(half), e1 = std::cos(half);
    const double c2 = c1 * c1 - s1 * s1, s2 = 2 * c1 * s1, d2 = 2 * d1 * e1;
    const double c3 = c2 * c1 - s2 * s1, s3 = s2 * c1 + c2 * s1, d3 = d1 * (3 - 4 * d1 * d1);
    c = 2 * c1 * d1;
    s = 2 * s1 * d1;
    const double cos2 = c2 * d2, sin2 = s2 * d2, cos3 = 2 * c3 * d3 / 3, sin3 = 2 * s3 * d3 / 3;
    cc = (width + cos2) / 2;
    cs = sin2 / 2;
    ss = (width - cos2) / 2;
    ccc = (3 * c + cos3) / 4;
    ccs = (s + sin3) / 4;
    css = (c - cos3) / 4;
    sss = (3 * s - sin3) / 4;
  }
  double width, c, s, cc, cs, ss, ccc, ccs, css, sss;
};

}  // namespace

UIntegral::UIntegral(const GeomAdaptor_Surface& surface, double u_min, double u_max)
    : surface_(surface), type_(surface.GetType()), u_min_(u_min) {
  gp_Ax3 frame;
  switch (type_) {
    case GeomAbs_Plane:
      frame = surface.Plane().Position();
      break;
    case GeomAbs_Cylinder:
      frame = surface.Cylinder().Position();
      radius_ = surface.Cylinder().Radius();
      break;
    case GeomAbs_Cone:
      frame = surface.Cone().Position();
      radius_ = surface.Cone().RefRadius();
      sine_ = std::sin(surface.Cone().SemiAngle());
      cosine_ = std::cos(surface.Cone().SemiAngle());
      break;
    case GeomAbs_Sphere:
      frame = surface.Sphere().Position();
      radius_ = surface.Sphere().Radius();
      break;
    case GeomAbs_Torus:
      frame = surface.Torus().Position();
      ring_ = surface.Torus().MajorRadius();
      radius_ = surface.Torus().MinorRadius();
      break;
    default:
      breaks_ = u_breaks(surface, u_min, u_max);
  }
  origin_ = to_array(frame.Location().XYZ());
  x_ = to_array(frame.XDirection().XYZ());
  y_ = to_array(frame.YDirection().XYZ());
  z_ = to_array(frame.Direction().XYZ());
  handedness_ = frame.Direct() ? 1 : -1;
}

Moments UIntegral::operator()(double u, double v) const {
  if (!breaks_.empty()) return by_quadrature(u, v);
  return type_ == GeomAbs_Plane ? on_plane(u, v) : around_axis(u, v);
}

UIntegral::Profile UIntegral::profile(double v) const {
  if (type_ == GeomAbs_Cylinder) return {radius_, v, 0, 1};
  if (type_ == GeomAbs_Cone) return {radius_ + v * sine_, v * cosine_, sine_, cosine_};
  const double c = radius_ * std::cos(v), s = radius_ * std::sin(v);
  return {ring_ + c, s, -s, c};
}

Moments UIntegral::on_plane(double u, double v) const {
  const double width = u - u_min_, middle = (u + u_min_) / 2;
  Moments m{};
  m[0] = width;
  for (std::size_t a = 0; a < 3; ++a) {
    const double n = handedness_ * z_[a], p = origin_[a] + middle * x_[a] + v * y_[a];
    m[1 + a] = n * p * width;
    m[4 + a] = n * width;
    m[7 + a] = n * (p * p + x_[a] * x_[a] * width * width / 12) / 2 * width;
  }
  return m;
}

// p = o + h z + r e with e = x cos u + y sin u, so n = r h' e - r r' z: polynomials of e, whose powers are those of cos
// and sin.
Moments UIntegral::around_axis(double u, double v) const {
  const Turn t(u_min_, u);
  const Profile at = profile(v);
  const double r = at.radius;
  Moments m{};
  m[0] = std::fabs(r) * std::hypot(at.radius_dv, at.height_dv) * t.width;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = x_[a], y = y_[a];
    const double e1 = x * t.c + y * t.s, e2 = x * x * t.cc + 2 * x * y * t.cs + y * y * t.ss;
    const double e3 = x * x * x * t.ccc + 3 * x * x * y * t.ccs + 3 * x * y * y * t.css + y * y * y * t.sss;
    const double c = origin_[a] + at.height * z_[a];
    const double across = handedness_ * r * at.height_dv, along = -handedness_ * r * at.radius_dv * z_[a];
    m[1 + a] = across * (c * e1 + r * e2) + along * (c * t.width + r * e1);
    m[4 + a] = across * e1 + along * t.width;
    m[7 + a] = (across * (c * c * e1 + 2 * c * r * e2 + r * r * e3) +
                along * (c * c * t.width + 2 * c * r * e1 + r * r * e2)) /
               2;
  }
  return m;
}

Moments UIntegral::by_quadrature(double u, double v) const {
  Moments sum{};
  // Pcurves may overshoot the bounds by a rounding error or, in periodic directions, lie beyond; the last span extends.
  for (std::size_t i = 0; i + 1 < breaks_.size(); ++i) {
    const bool last = i + 2 == breaks_.size();
    const double a = breaks_[i], b = last ? u : std::min(u, breaks_[i + 1]);
    if (i > 0 && b <= a) break;
    gauss(a, b, [&](double s, double weight) { add(sum, weight, integrand(surface_, s, v)); });
  }
  return sum;
}

}  // namespace meso::brep
