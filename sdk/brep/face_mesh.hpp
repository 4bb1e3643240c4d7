// SPDX-License-Identifier: Apache-2.0
#pragma once
// Meshes the faces of one shell so that the points on shared edges are equal bit for bit. Private.
//
// Ellipsoids have a formula (ellipsoid.hpp); plane faces with many loops get a Delaunay triangulation between the
// points of their edges (plane_mesh.hpp), because OpenCASCADE's mesher takes time quadratic in the loops of one face;
// all other faces are left to it. Where it leaves points of edges out, fails or turns triangles over, as in faces
// narrower than chords are off, they are made between the points of the edges (face_border.hpp).

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct MeshTolerance {
  double deflection_mm = 0.1;  ///< chord to surface
  double angle = 0.5;          ///< radians between neighbouring chords
};

/// Fills the meshes of `geometry`, which is the shell's template: faces in the order of an explorer, edges and vertices
/// in that of the maps. Outward triangles; an edge's points are the same for all faces that have it, an end point is
/// the vertex itself. Throws Standard_Failure where a face cannot be meshed.
void mesh_faces(const TopoDS_Shell& shell, const MeshTolerance& tolerance, const TopTools_IndexedMapOfShape& edges,
                const TopTools_IndexedMapOfShape& vertices, Template& geometry);

}  // namespace meso::brep
