// SPDX-License-Identifier: Apache-2.0
#include "realise_contacts.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "box_pairs.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

Box3 grown(const Box3& box) {
  const Vec3 d{clear_distance / 2, clear_distance / 2, clear_distance / 2};
  return {box.min - d, box.max + d};
}

bool balls_meet(const CellSolids& cells, const CellSolid& a, const CellSolid& b) {
  const Prototype &first = cells.prototypes[a.prototype], &second = cells.prototypes[b.prototype];
  return norm(a.placement * first.centre - b.placement * second.centre) <=
         first.radius + second.radius + clear_distance;
}

/// Pairs of cells stand in few different ways to each other: each is decided once.
class Neighbours {
 public:
  explicit Neighbours(const CellSolids& cells) : cells_(cells) {}

  bool touch(const CellSolid& a, const CellSolid& b) {
    const Affine a_from_b = inverse_of_rigid(a.placement) * b.placement;
    std::vector<std::int64_t> key{static_cast<std::int64_t>(a.prototype), static_cast<std::int64_t>(b.prototype)};
    for (const double m : a_from_b.linear.m) key.push_back(std::llround(m * 1e8));
    for (std::size_t i = 0; i < 3; ++i) key.push_back(std::llround(a_from_b.translation[i] * 1e7));
    const auto [known, fresh] = known_.try_emplace(std::move(key), false);
    if (fresh) known->second = decide(a, b, a_from_b);
    return known->second;
  }

 private:
  bool decide(const CellSolid& cell_a, const CellSolid& cell_b, const Affine& a_from_b) {
    const Prototype &a = cells_.prototypes[cell_a.prototype], &b = cells_.prototypes[cell_b.prototype];
    if (const FacetTree* facets = a.facets(); facets != nullptr && b.facets() != nullptr)
      return facets->is_within(clear_distance, *b.facets(), a_from_b) || holds_a_solid(a, b, a_from_b) ||
             holds_a_solid(b, a, inverse_of_rigid(a_from_b));
    if (holds_a_solid(a, b, a_from_b) || holds_a_solid(b, a, inverse_of_rigid(a_from_b))) return true;
    if (mutually_apart(a, a.mesh(), b, b.mesh(), a_from_b)) return false;
    if (proven_to_touch(a, b.mesh(), a_from_b) || proven_to_touch(b, a.mesh(), inverse_of_rigid(a_from_b))) return true;
    if (mutually_apart(a, fine_mesh(cell_a.prototype), b, fine_mesh(cell_b.prototype), a_from_b)) return false;
    for (const TopoDS_Shape& solid : a.solids)
      for (const TopoDS_Shape& other : b.solids)
        if (exact_distance(solid, mapped(other, a_from_b)) <= clear_distance) return true;
    return false;
  }

  static bool mutually_apart(const Prototype& a, const CoarseMesh& mesh_a, const Prototype& b, const CoarseMesh& mesh_b,
                             const Affine& a_from_b) {
    return proven_apart(a.surfaces, mesh_a, mesh_b.placed(a_from_b)) ||
           proven_apart(b.surfaces, mesh_b, mesh_a.placed(inverse_of_rigid(a_from_b)));
  }

  /// A tenth of the error: a millisecond where the exact distance takes ten.
  const CoarseMesh& fine_mesh(std::size_t prototype) {
    const auto [mesh, fresh] = fine_.try_emplace(prototype);
    if (fresh) mesh->second = coarse_mesh(cells_.prototypes[prototype].solids, 0.1);
    return mesh->second;
  }

  /// A solid that lies within another keeps clear of its surface, and yet the two overlap.
  static bool holds_a_solid(const Prototype& a, const Prototype& b, const Affine& a_from_b) {
    return std::ranges::any_of(b.anchors, [&](Vec3 anchor) {
      const Vec3 p = a_from_b * anchor;
      if (!a.box.intersects({p, p})) return false;
      if (a.is_enclosed_by_one_surface()) return a.surfaces.front().signed_distance(p) < 0;
      if (a.facets() != nullptr) return a.facets()->contains(p);
      return std::ranges::any_of(a.solids, [&](const TopoDS_Shape& solid) {
        BRepClass3d_SolidClassifier classifier(solid, to_pnt(p), clear_distance);
        return classifier.State() == TopAbs_IN;
      });
    });
  }

  /// A corner of the mesh, which lies on its body, is in or on the other: takes milliseconds, the distance a tenth of a
  /// second.
  static bool proven_to_touch(const Prototype& a, const CoarseMesh& mesh, const Affine& a_from_mesh) {
    std::vector<Vec3> near;
    for (const Vec3 point : mesh.points) {
      const Vec3 p = a_from_mesh * point;
      if (grown(a.box).intersects({p, p})) near.push_back(p);
    }
    if (near.empty()) return false;
    if (a.is_enclosed_by_one_surface())
      return std::ranges::any_of(near, [&](Vec3 p) { return a.surfaces.front().signed_distance(p) < 0; });
    return std::ranges::any_of(a.solids, [&](const TopoDS_Shape& solid) {
      BRepClass3d_SolidClassifier classifier(solid);
      return std::ranges::any_of(near, [&](Vec3 p) {
        classifier.Perform(to_pnt(p), clear_distance);
        return classifier.State() == TopAbs_IN || classifier.State() == TopAbs_ON;
      });
    });
  }

  const CellSolids& cells_;
  std::map<std::vector<std::int64_t>, bool> known_;
  std::map<std::size_t, CoarseMesh> fine_;  ///< by prototype
};

}  // namespace

Clusters clusters_of(const CellSolids& cells, const std::vector<bool>& taken) {
  Clusters out;
  out.of_cell.resize(cells.cells.size());
  std::iota(out.of_cell.begin(), out.of_cell.end(), 0);
  const auto root_of = [&](std::size_t cell) {
    auto i = static_cast<std::uint32_t>(cell);
    while (out.of_cell[i] != i) i = out.of_cell[i] = out.of_cell[out.of_cell[i]];
    return i;
  };
  std::vector<Box3> boxes;
  boxes.reserve(cells.cells.size());
  for (std::size_t i = 0; i < cells.cells.size(); ++i) {
    const Box3& box = cells.cells[i].box;
    boxes.push_back(!taken[i] || box.empty() ? Box3{} : grown(box));
  }
  Neighbours neighbours(cells);
  visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
    const std::uint32_t a = root_of(i), b = root_of(k);
    if (a == b || !balls_meet(cells, cells.cells[i], cells.cells[k])) return;
    if (neighbours.touch(cells.cells[i], cells.cells[k])) out.of_cell[std::max(a, b)] = std::min(a, b);
  });
  out.sizes.assign(cells.cells.size(), 0);
  for (std::size_t i = 0; i < cells.cells.size(); ++i) ++out.sizes[out.of_cell[i] = root_of(i)];
  return out;
}

}  // namespace meso::brep
