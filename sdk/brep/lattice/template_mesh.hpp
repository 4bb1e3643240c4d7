// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangulates the solids of all kinds of cells so that edges that are one modulo the lattice get the same points.
// Private.
//
//   const EdgePolygons polygons = mesh_alike(kinds, edge_count, fineness);   // leaves triangulations on the faces
//   share_points(face, geometry, polygons, tolerance);                       // for every face read from them

#include <vector>

#include "lattice/orbit_matcher.hpp"
#include "meso/brep/lattice_body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct TemplateEdges {
  const TopoDS_Shell& shell;
  const TopTools_IndexedMapOfShape& edges;
  const std::vector<OrbitMatcher::Match>& matches;  ///< of edges(i + 1)
};

/// Per edge of the template: the points between its ends.
using EdgePolygons = std::vector<std::vector<Vec3>>;

/// Throws Standard_Failure.
[[nodiscard]] EdgePolygons mesh_alike(const std::vector<TemplateEdges>& kinds, const Template& geometry,
                                      const MeshFineness& fineness);

/// Names every point of the face's mesh that is on an edge or vertex by that edge's own point, so that neighbours agree
/// on it bit for bit. False if the mesh does not have all of them.
[[nodiscard]] bool share_points(FaceTemplate& face, const Template& geometry, const EdgePolygons& polygons,
                                double tolerance);

}  // namespace meso::brep
