// SPDX-License-Identifier: Apache-2.0
#pragma once
// Makes the edges of opposite box walls end at the same points. Private.
//
// Two cells cut the same circle in a common wall, but a surface's seam may have divided it on one side only. An edge is
// therefore divided wherever a vertex of any of the solids, moved by a period, lies on it.

#include <vector>

#include "lattice/cell_solid.hpp"

namespace meso::brep {

/// False if a division fails. Throws Standard_Failure.
[[nodiscard]] bool divide_alike(std::vector<TopoDS_Shape>& solids, const CellShape& cell);

/// The solid with its edges divided at `points`, by a boolean of the solid with the points; null if that fails.
[[nodiscard]] TopoDS_Shape divided_at(const TopoDS_Shape& solid, const std::vector<Vec3>& points);

}  // namespace meso::brep
