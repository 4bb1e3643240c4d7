// SPDX-License-Identifier: Apache-2.0
#pragma once
// Cylinders, cones, balls and tori that a file states as swept curves. Private.
//
//   shape = with_elementary_faces(shape);
//
// IGES has surfaces of revolution where a body has elementary surfaces, and booleans with those take ten times as long.
// Faces whose swept line or circle makes one are put on it; edges keep their curves, parameters of faces move or change
// their sign. Points and the area of a face must stay where they are, else the face stays as it was. Lengths in
// millimetres. May throw Standard_Failure. Adds to the edges of `shape`: not to be called for one shape by two threads.

#include "occt.hpp"

namespace meso::brep {

[[nodiscard]] TopoDS_Shape with_elementary_faces(const TopoDS_Shape& shape);

}  // namespace meso::brep
