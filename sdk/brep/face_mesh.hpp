// SPDX-License-Identifier: Apache-2.0
#pragma once
// Copies OpenCASCADE's triangulations of faces so that the points on edges are equal bit for bit. Private.

#include <vector>

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// One for all faces of a shell, in any order: an edge's points are those of the first face that has it, an end point
/// is the vertex itself.
class FaceMesher {
 public:
  FaceMesher(const TopTools_IndexedMapOfShape& edges, const TopTools_IndexedMapOfShape& vertices,
             const std::vector<Vec3>& vertex_points)
      : edges_(edges), vertices_(vertices), vertex_points_(vertex_points), edge_points_(edges.Extent() + 1) {}

  /// Outward triangles; those that an edge of zero length folds up are left out. Throws Standard_Failure without a
  /// triangulation.
  [[nodiscard]] Triangulation mesh_of(const TopoDS_Face& face);

 private:
  void take_edge_points(const TopoDS_Face& face, const TopoDS_Edge& edge, std::vector<MeshPoint>& points);

  const TopTools_IndexedMapOfShape& edges_;
  const TopTools_IndexedMapOfShape& vertices_;
  const std::vector<Vec3>& vertex_points_;
  std::vector<std::vector<Vec3>> edge_points_;  // by index in edges_, along the edge's forward direction
};

}  // namespace meso::brep
