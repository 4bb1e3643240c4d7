// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does the surface of a solid from a foreign file pass through itself? Each edge may have its two faces and the volume
// a positive sign, and no boolean is right on it all the same. Private.
//
// Told by triangles a thousandth of the solid's size off its faces, and again by ones a quarter as far: they pass
// through each other by more than both are off. Shallower crossings are not seen, nor is a solid that OpenCASCADE
// cannot mesh. Cost: OpenCASCADE's mesher, 0.1 to 1 ms a face, and 1 us a triangle.

#include <optional>

#include "meso/base/vec.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// A point near the deepest crossing that was found, or nothing.
[[nodiscard]] std::optional<Vec3> self_crossing(const TopoDS_Shape& solid);

}  // namespace meso::brep
