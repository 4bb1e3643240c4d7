// SPDX-License-Identifier: Apache-2.0
#pragma once
// Points well within a solid: a face's middle, moved inwards. Private.

#include <vector>

#include "occt.hpp"

namespace meso::brep {

/// Up to `count` points, each from another face, evenly spread over the list of faces; fewer (also none) where a solid
/// is too thin to say. Cost: some classifications of a point by the solid. May throw Standard_Failure.
[[nodiscard]] std::vector<Vec3> points_within(const TopoDS_Shape& solid, std::size_t count);

}  // namespace meso::brep
