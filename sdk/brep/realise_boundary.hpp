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
  /// Which solid a point is in; -1: none.
  [[nodiscard]] int solid_at(Vec3 p) const;

 private:
  /// Of the body's extreme points some are inside and some are not: a quick proof that it crosses.
  [[nodiscard]] bool reaches_both_sides(const CoarseMesh& mesh) const;

  Solids solids_;
  std::vector<Box3> boxes_;  ///< of the solids
  std::vector<CarrierSurface> surfaces_;
  mutable std::vector<std::unique_ptr<BRepClass3d_SolidClassifier>> classifiers_;
};

}  // namespace meso::brep
