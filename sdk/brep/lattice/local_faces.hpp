// SPDX-License-Identifier: Apache-2.0
#pragma once
// The faces of a body as one cell needs them: where no edge of a face comes near the cell, a small patch of its surface
// stands for the face; of a face with many edges, the part near the cell (face_windows). Private.
//
// Surfaces are intersected over all that a face covers: a patch of the cell's size costs a tenth of a whole torus, and
// its seam and poles are turned to where the cell is not. Thread rule: one for each thread; it works on a copy.

#include <vector>

#include "lattice/face_windows.hpp"

namespace meso::brep {

class LocalFaces {
 public:
  LocalFaces(const BodySurface& surface, const CellGrid& grid);

  struct Near {
    std::vector<TopoDS_Shape> solids;    ///< compounds of faces, one for each solid of the body
    std::vector<std::size_t> stand_for;  ///< per face: for which of those that were asked for
  };
  /// Those faces in the body's frame; if `patches` is not set, whole but for those with many edges
  /// or long ones.
  [[nodiscard]] Near near(const Index3& cell, const std::vector<std::uint32_t>& faces, bool patches) const;

 private:
  [[nodiscard]] TopoDS_Face patch(std::uint32_t number, const Index3& cell) const;
  [[nodiscard]] ParameterRange window(std::uint32_t number, const Index3& cell, double margin) const;

  const BodySurface& surface_;
  CellGrid grid_;
  std::vector<FaceEdges> faces_;
  std::vector<std::uint32_t> solid_of_;
  std::vector<bool> is_long_;  ///< has an edge that is to be cut in a window
};

}  // namespace meso::brep
