// SPDX-License-Identifier: Apache-2.0
#include "realise_boundary.hpp"

#include <algorithm>
#include <cmath>

#include "boolean.hpp"

namespace meso::brep {
namespace {

Box3 grown(const Box3& box) {
  const Vec3 d{clear_distance, clear_distance, clear_distance};
  return {box.min - d, box.max + d};
}

bool contains(const Box3& outer, const Box3& inner) {
  for (std::size_t i = 0; i < 3; ++i)
    if (inner.min[i] < outer.min[i] || inner.max[i] > outer.max[i]) return false;
  return true;
}

}  // namespace

Boundary::Boundary(const Solids& solids) : solids_(solids) {
  for (const TopoDS_Shape& solid : solids_) {
    boxes_.push_back(box_of(solid));
    classifiers_.push_back(std::make_unique<BRepClass3d_SolidClassifier>(solid));
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
      surfaces_.emplace_back(TopoDS::Face(it.Current()));
  }
  for (const TopoDS_Shape& solid : solids_) {
    auto triangles = facets_of({solid});
    if (!triangles) {
      facets_.clear();
      break;
    }
    facets_.emplace_back(std::move(*triangles));
  }
}

Place Boundary::place(const CellSolids& cells, const CellSolid& cell) const {
  const Box3 box = grown(cell.box);
  if (std::ranges::none_of(boxes_, [&](const Box3& b) { return b.intersects(box); })) return Place::outside;
  if (std::ranges::any_of(boxes_, [&](const Box3& b) { return contains(box, b); })) return Place::crossing;
  if (!facets_.empty())
    if (const FacetTree* facets = cells.prototypes[cell.prototype].facets())
      return place_facets(*facets, cells.anchors_of(cell), cell.placement);
  const CoarseMesh mesh = cells.mesh_of(cell);
  if (mesh.points.empty() && std::isfinite(mesh.error)) return Place::outside;
  std::optional<Solids> body;
  for (const CarrierSurface& surface : surfaces_) {
    if (!surface.box().intersects(box)) continue;
    // A face that the cell's body may enclose has the cell's surface on one side.
    if (!contains(box, surface.box()) && proven_side(surface, mesh, clear_distance) != 0) continue;
    if (!body) {
      if (!mesh.points.empty() && reaches_both_sides(mesh)) return Place::crossing;
      body = cells.solids_of(cell);
    }
    for (const TopoDS_Shape& solid : *body)
      if (exact_distance(solid, surface.face()) <= clear_distance) return Place::crossing;
  }
  return place_clear(cells.anchors_of(cell));
}

Place Boundary::place_facets(const FacetTree& cell, const std::vector<Vec3>& anchors, const Affine& placement) const {
  const auto is_near = [&](const FacetTree& solid) { return solid.is_within(clear_distance, cell, placement); };
  return std::ranges::any_of(facets_, is_near) ? Place::crossing : place_clear(anchors);
}

Place Boundary::place_clear(const std::vector<Vec3>& anchors) const {
  const auto inside = std::ranges::count_if(anchors, [this](Vec3 p) { return solid_at(p) >= 0; });
  if (inside == 0) return Place::outside;
  return inside == std::ssize(anchors) ? Place::inside : Place::crossing;
}

bool Boundary::reaches_both_sides(const CoarseMesh& mesh) const {
  bool inside = false, outside = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::ranges::minmax_element(mesh.points, {}, [&](Vec3 p) { return p[axis]; });
    for (const Vec3 p : {*low, *high}) (solid_at(p) >= 0 ? inside : outside) = true;
  }
  return inside && outside;
}

bool Boundary::is_clear_by(double clearance, const CellSolids& cells, const CellSolid& cell) const {
  const FacetTree* facets = facets_.empty() ? nullptr : cells.prototypes[cell.prototype].facets();
  if (facets == nullptr) return distance(cells.solids_of(cell)) >= clearance;
  return std::ranges::none_of(
      facets_, [&](const FacetTree& solid) { return solid.is_within(clearance, *facets, cell.placement); });
}

bool Boundary::sticks_out(double by, const CellSolids& cells, const CellSolid& cell) const {
  const FacetTree* facets = facets_.empty() ? nullptr : cells.prototypes[cell.prototype].facets();
  if (facets == nullptr) return false;
  const auto is_out = [&](Vec3 p) {
    return solid_at(p) < 0 &&
           std::ranges::none_of(facets_, [&](const FacetTree& solid) { return solid.is_within(by, p); });
  };
  const auto has_one_out = [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](Vec3 p) { return is_out(cell.placement * p); });
  };
  if (std::ranges::any_of(facets->triangles(), has_one_out)) return true;
  const Affine cell_from_world = inverse_of_rigid(cell.placement);
  const auto is_in_cell = [&](Vec3 p) { return facets->contains(p) && !facets->is_within(by, p); };
  return std::ranges::any_of(facets_, [&](const FacetTree& solid) {
    return std::ranges::any_of(solid.triangles(), [&](const Triangle& t) {
      return std::ranges::any_of(t, [&](Vec3 p) { return is_in_cell(cell_from_world * p); });
    });
  });
}

double Boundary::distance(const Solids& body) const {
  double nearest = HUGE_VAL;
  for (const TopoDS_Shape& solid : body)
    for (const CarrierSurface& surface : surfaces_) nearest = std::min(nearest, exact_distance(solid, surface.face()));
  return nearest;
}

int Boundary::solid_at(Vec3 p) const {
  for (std::size_t i = 0; i < facets_.size(); ++i)
    if (facets_[i].contains(p) && !facets_[i].is_within(Precision::Confusion(), p)) return static_cast<int>(i);
  if (!facets_.empty()) return -1;
  for (std::size_t i = 0; i < classifiers_.size(); ++i) {
    classifiers_[i]->Perform(to_pnt(p), Precision::Confusion());
    if (classifiers_[i]->State() == TopAbs_IN) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace meso::brep
