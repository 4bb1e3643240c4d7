// SPDX-License-Identifier: Apache-2.0
#pragma once
// The placed cells of a pattern as solids: each different body is made once and placed often. Private.

#include <optional>
#include <span>

#include "facet_tree.hpp"
#include "meso/eval/evaluation.hpp"
#include "realise_clearance.hpp"

namespace meso::brep {

/// A body that several cells have, up to a rigid movement.
struct Prototype {
  Solids solids;
  Box3 box;
  Vec3 centre;  ///< of a ball around it
  double radius = 0;
  std::vector<Vec3> anchors;  ///< one point of each solid's surface
  std::vector<CarrierSurface> surfaces;
  bool is_simple = true;  ///< no solid has a void of its own

  /// Made when first asked for: of most cutters box and ball are enough.
  [[nodiscard]] const CoarseMesh& mesh() const {
    if (!mesh_) mesh_ = coarse_mesh(solids);
    return *mesh_;
  }
  /// Null unless all faces are plane between straight lines. Made when first asked for.
  [[nodiscard]] const FacetTree* facets() const;
  [[nodiscard]] bool is_enclosed_by_one_surface() const { return surfaces.size() == 1 && surfaces.front().is_closed(); }

 private:
  mutable std::optional<CoarseMesh> mesh_;
  mutable std::optional<std::optional<FacetTree>> facets_;
};

struct CellSolid {
  std::size_t prototype = 0;
  Affine placement;  ///< world_from_prototype, rigid
  Box3 box;          ///< in the world
};

struct CellSolids {
  std::vector<Prototype> prototypes;
  std::vector<CellSolid> cells;  ///< in normative order

  [[nodiscard]] Solids solids_of(const CellSolid& cell) const;
  [[nodiscard]] CoarseMesh mesh_of(const CellSolid& cell) const;
  [[nodiscard]] std::vector<Vec3> anchors_of(const CellSolid& cell) const;
};

/// Cell bodies, or the space the cells take up (their boxes). Empty with a diagnostic on any fault. May throw
/// Standard_Failure.
enum class CellPart { body, region };
[[nodiscard]] std::optional<CellSolids> cell_solids(const eval::CellStream& cells, CellPart what,
                                                    const SolidContext& context);

/// The same for the cells with these ordinals only, where they exist.
[[nodiscard]] std::optional<CellSolids> cell_solids_at(const eval::CellStream& cells,
                                                       std::span<const std::uint64_t> ordinals, CellPart what,
                                                       const SolidContext& context);

/// world_from_source of source_from_world, both rigid.
[[nodiscard]] inline Affine inverse_of_rigid(const Affine& rigid) {
  const Mat3 back = transposed(rigid.linear);
  return {back, -(back * rigid.translation)};
}

}  // namespace meso::brep
