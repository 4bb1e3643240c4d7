// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is in a cell box, put together face by face where struts part on the balls of their nodes (jointed_box.hpp): no
// boolean, a few milliseconds a face, and points in which struts, balls and sides only touch are corners as others are.
// Private.

#include <optional>
#include <string>
#include <vector>

#include "meso/brep/lattice_body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// The union of balls and struts in the box, as a compound of solids; null if nothing of it is there. Empty, and why,
/// where it is not of that form. For each variant its balls have other axes, which show in how a body cuts them.
/// May throw Standard_Failure. Thread rule: pure.
[[nodiscard]] std::optional<TopoDS_Shape> jointed_cell(const std::vector<CellPrimitive>& primitives, const Box3& box,
                                                       double tolerance, int variant, std::string& why);

}  // namespace meso::brep
