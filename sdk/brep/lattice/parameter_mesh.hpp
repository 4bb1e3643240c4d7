// SPDX-License-Identifier: Apache-2.0
#pragma once
// `bordered_mesh` for the faces of cells, whose edges have their points in common with those of other cells. Private.

#include <set>

#include "face_border.hpp"
#include "lattice/template_mesh.hpp"

namespace meso::brep {

/// As bordered_mesh().
[[nodiscard]] std::optional<BorderedMesh> parameter_mesh(const TopoDS_Face& face, const TemplateEdges& kind,
                                                         const Template& geometry, const EdgePolygons& polygons);

/// A point that an edge of the template needs between two of its own.
struct OrbitPoint {
  std::uint32_t edge = 0;
  std::size_t segment = 0;  ///< of its polygon, counted from vertex 0
  double at = 0;            ///< along the segment, 0 to 1
  Vec3 point;
};
[[nodiscard]] OrbitPoint of_orbit(const NeededPoint& p, const TemplateEdges& kind, const Template& geometry,
                                  const EdgePolygons& polygons);

/// Of points that are close together one is taken. The edges that have new points.
std::set<std::uint32_t> insert(std::vector<OrbitPoint> needed, EdgePolygons& polygons);

}  // namespace meso::brep
