// SPDX-License-Identifier: Apache-2.0
#pragma once
// Divides triangles of a meshed body until none passes through another.
//
//   if (clear_triangles(body, run) == 0) ...   // the STL has no self-contacts
//
// Chords leave their surfaces. Where two faces come close (struts that part at a sharp angle, a thin wall between two
// balls) triangles of one can pass through those of the other although the surfaces keep apart. Segments of such
// triangles are halved at the surface, or at the edge, in all faces that have them, until no two triangles meet as an
// STL file rounds them. Of a lattice one instance of each face is looked at, and all faces around it. Faces on
// B-splines keep their triangles; surfaces that touch, touch; a body whose templates have more than 50 000 triangles
// stays as it is: what is meshed so finely seldom meets itself, and looking would take longer than meshing. Cost:
// about 2 us a triangle that is looked at. Thread rule: changes `body` alone; templates that other bodies share are
// copied first.

#include "meso/base/run_options.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

/// How many of the given triangles meet others and are left as they are, but where a neighbour's division cuts them:
/// zero, but where surfaces touch or the run was to stop. Where it was, `body` is as it was.
[[nodiscard]] std::size_t clear_triangles(Body& body, const RunOptions& run);

}  // namespace meso::brep
