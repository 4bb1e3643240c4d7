// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where bodies stand to the boundary of a macrostructure: inside, outside, or across it. Private.

#include <memory>

#include "realise_cells.hpp"

namespace meso::brep {

/// `inside` and `outside` keep clear of the boundary (clear_distance); everything else is `crossing`.
enum class Place { inside, outside, crossing };

class Boundary {
 public:
  explicit Boundary(const Solids& solids);

  /// May throw Standard_Failure.
  [[nodiscard]] Place place(const CellSolids& cells, const CellSolid& cell) const;
  /// Distance of the body from the boundary. May throw Standard_Failure.
  [[nodiscard]] double distance(const Solids& body) const;
  /// Is the cell, which does not cross, at least that far from the boundary? May throw Standard_Failure.
  [[nodiscard]] bool is_clear_by(double clearance, const CellSolids& cells, const CellSolid& cell) const;
  /// True if a corner of the cell is proven to stick out of the body by more than `by`, or one of the body into the
  /// cell. May throw Standard_Failure.
  [[nodiscard]] bool sticks_out(double by, const CellSolids& cells, const CellSolid& cell) const;
  /// Which solid a point is in; -1: none.
  [[nodiscard]] int solid_at(Vec3 p) const;

 private:
  /// Of the body's extreme points some are inside and some are not: a quick proof that it crosses.
  [[nodiscard]] bool reaches_both_sides(const CoarseMesh& mesh) const;

  [[nodiscard]] Place place_facets(const FacetTree& cell, const std::vector<Vec3>& anchors,
                                   const Affine& placement) const;
  /// Clear of the boundary, each of a cell's solids is wholly on one side; they need not all be on the same.
  [[nodiscard]] Place place_clear(const std::vector<Vec3>& anchors) const;

  Solids solids_;
  std::vector<Box3> boxes_;        ///< of the solids
  std::vector<FacetTree> facets_;  ///< of the solids, if all of them are of plane facets
  std::vector<CarrierSurface> surfaces_;
  mutable std::vector<std::unique_ptr<BRepClass3d_SolidClassifier>> classifiers_;
};

}  // namespace meso::brep
