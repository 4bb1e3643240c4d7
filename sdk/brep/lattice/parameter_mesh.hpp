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

/// In the numbers of the template's edges.
[[nodiscard]] PolygonPoint of_orbit(const NeededPoint& p, const TemplateEdges& kind, const Template& geometry,
                                    const EdgePolygons& polygons);

/// The edges that have new points.
std::set<std::uint32_t> insert(std::vector<PolygonPoint> needed, EdgePolygons& polygons);

}  // namespace meso::brep
