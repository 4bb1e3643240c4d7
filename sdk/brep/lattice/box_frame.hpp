// SPDX-License-Identifier: Apache-2.0
#pragma once
// A box and what is in it: the sides of the box divided along the walls of the solids within, and along those of the
// boxes beside. Private.
//
// A body is united with the solids of a box by what it leaves of the space beside them: cell_split divides that as it
// divides any solid. The sides belong to it, so a box and the one across end up with the same walls.

#include "lattice/whole_cell.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

/// The faces of a solid that lie in one side of a box.
struct WallFaces {
  std::vector<TopoDS_Face> faces;  ///< outward of their solid
  double area = 0;
  Vec3 moment;  ///< of the area

  /// The same region of a plane, `other` being moved by `shift`.
  [[nodiscard]] bool is_same(const WallFaces& other, Vec3 shift, double size) const;
};

/// Sides are numbered 2 * axis + (0 low, 1 high).
using BoxWalls = std::array<WallFaces, 6>;
[[nodiscard]] BoxWalls walls_of(const TopoDS_Shape& solid, const Box3& box, double tolerance);

/// The space that the solids leave of the box. `solid` may be null; `outlines` lie in sides of the box and divide
/// those. Throws Standard_Failure where the sides cannot be divided along the walls.
[[nodiscard]] WholeCell box_frame(const TopoDS_Shape& solid, const Box3& box, const std::vector<TopoDS_Shape>& outlines,
                                  double deflection, const RunOptions& run);

/// The whole box, with its sides divided.
[[nodiscard]] TopoDS_Shape filled_box(const Box3& box, const std::vector<TopoDS_Shape>& outlines,
                                      const RunOptions& run);

}  // namespace meso::brep
