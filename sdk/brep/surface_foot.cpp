// SPDX-License-Identifier: Apache-2.0
#include "surface_foot.hpp"

#include <ShapeAnalysis_Surface.hxx>
#include <cmath>

#include "surface_point.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr double search_tolerance = 1e-9;

}  // namespace

// Newton's method for the zero of the derivatives of |S(u, v) - p|^2 / 2.
std::optional<gp_Pnt2d> foot_beside(ShapeAnalysis_Surface& surface, const gp_Pnt2d& start, Vec3 p) {
  constexpr int most_steps = 12;
  constexpr double flat = 1e-10;  // of the angle between the parameter lines
  double first[2], last[2];
  surface.Bounds(first[0], last[0], first[1], last[1]);
  double uv[2] = {start.X(), start.Y()};
  for (int n = 0; n < most_steps; ++n) {
    gp_Pnt s;
    gp_Vec su, sv, suu, svv, suv;
    surface.Adaptor3d()->D2(uv[0], uv[1], s, su, sv, suu, svv, suv);
    const gp_Vec r(to_pnt(p), s);
    const double a = su * su + r * suu, b = su * sv + r * suv, c = sv * sv + r * svv;
    const double det = a * c - b * b, gu = r * su, gv = r * sv;
    if (!(det > flat * (su * su) * (sv * sv))) return {};
    const double step[2] = {(b * gv - c * gu) / det, (b * gu - a * gv) / det};
    for (int i = 0; i < 2; ++i) uv[i] = std::min(std::max(uv[i] + step[i], first[i]), last[i]);
    if (std::abs(step[0]) * su.Magnitude() + std::abs(step[1]) * sv.Magnitude() < search_tolerance)
      return gp_Pnt2d(uv[0], uv[1]);
  }
  return {};
}

SurfaceFoot::SurfaceFoot(const Surface& surface) : surface_(surface) {
  if (std::holds_alternative<BSplineSurface>(surface)) search_ = new ShapeAnalysis_Surface(to_geom(surface));
}

Vec3 SurfaceFoot::operator()(Vec3 p, double near_mm) {
  if (search_.IsNull() || !std::isfinite(p.x + p.y + p.z)) return nearest_point(surface_, p);
  // A search that begins at the last answer can end on the far side of a body: what is not at hand is searched for from
  // anywhere.
  const auto distance = [&](const gp_Pnt2d& uv) { return norm(to_vec(search_->Value(uv)) - p); };
  const std::optional<gp_Pnt2d> beside = has_last_ ? foot_beside(*search_, last_, p) : std::nullopt;
  if (beside && distance(*beside) <= near_mm) {
    last_ = *beside;
  } else {
    last_ = search_->ValueOfUV(to_pnt(p), search_tolerance);
    if (beside && distance(*beside) < distance(last_)) last_ = *beside;
  }
  has_last_ = true;
  return to_vec(search_->Value(last_));
}

}  // namespace meso::brep
