// SPDX-License-Identifier: Apache-2.0
#pragma once
// Divides the triangles of a face where they are too far from its surface. Private.
//
// OpenCASCADE's mesher aims at a deflection and can miss it threefold: between two close circles on a small ball it
// leaves chords over the ball. Segments between two triangles are halved at the surface until none is too far off;
// those on the border stay as they are, so neighbours go on fitting.

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// `mesh` is in the frame of `surface`, offsets counted in `lattice`. Throws Standard_Failure.
void fit_triangles(Triangulation& mesh, const Handle(Geom_Surface) & surface, const Mat3& lattice, double deflection);

}  // namespace meso::brep
