// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangulates the solids of all kinds of cells so that edges that are one modulo the lattice get the same points.
// Private.
//
//   const EdgePolygons polygons = mesh_alike(kinds, geometry, fineness, run);  // leaves triangulations on the faces
//   face.mesh = named_mesh(shape, kind, geometry, polygons, fineness);       // for every face read from them
//
// Each edge is divided once. A face that cannot be meshed within polygons so coarse has those of its edges divided
// further, wherever they stand.

#include <optional>
#include <vector>

#include "face_border.hpp"
#include "lattice/orbit_matcher.hpp"
#include "meso/base/run_options.hpp"
#include "meso/brep/lattice_body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct TemplateEdges {
  const TopoDS_Shell& shell;
  const TopTools_IndexedMapOfShape& edges;
  const std::vector<OrbitMatcher::Match>& matches;  ///< of edges(i + 1)

  [[nodiscard]] const OrbitMatcher::Match& match_of(const TopoDS_Edge& edge) const {
    return matches.at(static_cast<std::size_t>(edges.FindIndex(edge) - 1));
  }
};

/// Per edge of the template: the points between its ends.
using EdgePolygons = std::vector<std::vector<Vec3>>;

/// The points between the ends of an edge of a kind, along that edge.
[[nodiscard]] std::vector<Vec3> points_of(const OrbitMatcher::Match& match, const Template& geometry,
                                          const EdgePolygons& polygons);

/// Throws Standard_Failure, also where the run is to stop.
[[nodiscard]] EdgePolygons mesh_alike(const std::vector<TemplateEdges>& kinds, const Template& geometry,
                                      const MeshFineness& fineness, const RunOptions& run);

/// The triangulation of a face of `kind`. Every point on an edge or vertex is named by that edge's own point, so that
/// neighbours agree on it bit for bit; triangles that this folds up are left out. Empty if the triangles' border is not
/// exactly the polygons of the edges.
[[nodiscard]] std::optional<Triangulation> named_mesh(const TopoDS_Face& face, const TemplateEdges& kind,
                                                      const Template& geometry, const EdgePolygons& polygons,
                                                      const MeshFineness& fineness);

}  // namespace meso::brep
