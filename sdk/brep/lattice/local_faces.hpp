// SPDX-License-Identifier: Apache-2.0
#pragma once
// The faces of a body as one cell needs them: where no edge of a face comes near the cell, a small patch of its surface
// stands for the face. Private.
//
// Surfaces are intersected over all that a face covers: a patch of the cell's size costs a tenth of a whole torus, and
// its seam and poles are turned to where the cell is not. Thread rule: one for each thread; it works on a copy.

#include <vector>

#include "lattice/body_surface.hpp"

namespace meso::brep {

class LocalFaces {
 public:
  LocalFaces(const BodySurface& surface, const CellGrid& grid);

  /// Those faces in the body's frame, one compound for each solid of the body; whole if `patches` is not set.
  [[nodiscard]] std::vector<TopoDS_Shape> near(const Index3& cell, const std::vector<std::uint32_t>& faces,
                                               bool patches) const;

 private:
  [[nodiscard]] TopoDS_Face patch(std::uint32_t number, const Index3& cell) const;

  const BodySurface& surface_;
  CellGrid grid_;
  std::vector<TopoDS_Face> faces_;
  std::vector<std::uint32_t> solid_of_;
};

}  // namespace meso::brep
