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

Vec3 SurfaceFoot::operator()(Vec3 p) {
  if (search_.IsNull() || !std::isfinite(p.x + p.y + p.z)) return nearest_point(surface_, p);
  last_ = has_last_ ? search_->NextValueOfUV(last_, to_pnt(p), search_tolerance)
                    : search_->ValueOfUV(to_pnt(p), search_tolerance);
  has_last_ = true;
  return to_vec(search_->Value(last_));
}

}  // namespace meso::brep
