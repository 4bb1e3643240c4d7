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

SurfaceFoot::SurfaceFoot(const Surface& surface) : surface_(surface) {
  if (std::holds_alternative<BSplineSurface>(surface)) search_ = new ShapeAnalysis_Surface(to_geom(surface));
}

Vec3 SurfaceFoot::operator()(Vec3 p, double near_mm) {
  if (search_.IsNull() || !std::isfinite(p.x + p.y + p.z)) return nearest_point(surface_, p);
  // A search that begins at the last answer can end on the far side of a body: what is not at hand is searched for from
  // anywhere.
  const auto distance = [&](const gp_Pnt2d& uv) { return norm(to_vec(search_->Value(uv)) - p); };
  gp_Pnt2d nearest = has_last_ ? search_->NextValueOfUV(last_, to_pnt(p), search_tolerance) : gp_Pnt2d();
  if (!has_last_ || distance(nearest) > near_mm) {
    const gp_Pnt2d anywhere = search_->ValueOfUV(to_pnt(p), search_tolerance);
    if (!has_last_ || distance(anywhere) < distance(nearest)) nearest = anywhere;
  }
  last_ = nearest;
  has_last_ = true;
  return to_vec(search_->Value(last_));
}

}  // namespace meso::brep
