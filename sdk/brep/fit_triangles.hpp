// SPDX-License-Identifier: Apache-2.0
#pragma once
// Divides the triangles of a face where they are too far from its surface, or would meet those of another. Private.
//
// OpenCASCADE's mesher aims at a deflection and can miss it threefold: between two close circles on a small ball it
// leaves chords over the ball. Segments between two triangles are halved at the surface until none is too far off;
// those on the border stay as they are, so neighbours go on fitting.

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// `mesh` is in the frame of `surface`, offsets counted in `lattice`. Throws Standard_Failure.
void fit_triangles(Triangulation& mesh, const Handle(Geom_Surface) & surface, const Mat3& lattice, double deflection);

struct MeshedFace {
  Triangulation* mesh = nullptr;
  Handle(Geom_Surface) surface;
  bool is_wall = false;  ///< lies in a wall of the box
};

/// Thin faces can share two points and no edge. The faces of one solid in a box: halves the segments between two
/// triangles of a face that another face has, too, or, in a wall, may have. Throws Standard_Failure.
void part_segments(const std::vector<MeshedFace>& faces, const Mat3& lattice, const Box3& box, double tolerance);

}  // namespace meso::brep
