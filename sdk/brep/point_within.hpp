// SPDX-License-Identifier: Apache-2.0
#pragma once
// Points by which pieces are judged: well within a solid (a face's middle, moved inwards), along its edges and on
// its faces.
// Private.

#include <vector>

#include "occt.hpp"

namespace meso::brep {

/// Up to `count` points, each from another face, evenly spread over the list of faces; fewer (also none) where a solid
/// is too thin to say. Cost: some classifications of a point by the solid. May throw Standard_Failure.
[[nodiscard]] std::vector<Vec3> points_within(const TopoDS_Shape& solid, std::size_t count);

/// `each` points between the ends of every edge. A face that was not divided where it should have been has edges on the
/// wrong side of what should have divided it.
[[nodiscard]] std::vector<Vec3> points_along_edges(const TopoDS_Shape& shape, std::size_t each);

/// Of a grid of `each` x `each` parameters over every face, those that lie in it.
[[nodiscard]] std::vector<Vec3> points_on_faces(const TopoDS_Shape& shape, std::size_t each);

}  // namespace meso::brep
