// SPDX-License-Identifier: Apache-2.0
#include "point_in_solid.hpp"

#include <BRepBndLib.hxx>

#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t many_facets = 40, many_faces = 100;

}  // namespace

PointInSolid::PointInSolid(const TopoDS_Shape& solid) : solid_(solid) {
  BRepBndLib::Add(solid, box_);
  std::size_t faces = 0;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) ++faces;
  if (faces >= many_facets)
    if (auto facets = facets_of({solid})) facets_.emplace(std::move(*facets));
  if (!facets_ && faces >= many_faces) rays_.emplace(solid);
}

bool PointInSolid::is_beyond_box(Vec3 p) const { return box_.IsOut(to_pnt(p)); }

TopAbs_State PointInSolid::state(Vec3 p, double tolerance_mm) {
  if (is_beyond_box(p)) return TopAbs_OUT;
  if (facets_) {
    if (facets_->is_within(tolerance_mm, p)) return TopAbs_ON;
    return facets_->contains(p) ? TopAbs_IN : TopAbs_OUT;
  }
  if (rays_)
    if (const auto state = rays_->state(p, tolerance_mm)) return *state;
  if (!is_loaded_) classifier_.Load(solid_);
  is_loaded_ = true;
  classifier_.Perform(to_pnt(p), tolerance_mm);
  return classifier_.State();
}

}  // namespace meso::brep
