// SPDX-License-Identifier: Apache-2.0
#pragma once
// Faces of balls whose loops touch themselves, divided for the file: OpenCASCADE's reader takes loops that share a
// vertex for loops that cross, and no longer knows on which side of them the face is.

#include <vector>

#include "sphere_loops.hpp"

namespace meso::step {

/// Edges and vertices are those of `border`: first those of the face, which are number edges[i] and vertices[i] of its
/// template, then those that divide it, which belong to no other face.
struct SpherePieces {
  brep::Template border;
  std::vector<std::uint32_t> edges, vertices;
  std::vector<brep::FaceTemplate> pieces;
};

/// Pieces of a face on `sphere` whose loops pass no vertex twice. Nothing where it is not to be divided: its loops do
/// not, it has a seam, or no two arcs of great circles lead clear of everything from one side of such a vertex to the
/// other.
[[nodiscard]] SpherePieces divided(const brep::SphereSurface& sphere, const brep::FaceTemplate& face,
                                   const brep::Template& geometry);

}  // namespace meso::step
