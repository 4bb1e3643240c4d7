// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of a face for which OpenCASCADE has none: it gives up on slivers, and where two arcs of a ball run into one
// point. Private.

#include "lattice/template_mesh.hpp"

namespace meso::brep {

/// Between the points of its edges: in a plane, where all of them are in one, and on balls. Empty on other surfaces.
[[nodiscard]] std::optional<Triangulation> border_mesh(const TopoDS_Face& face, const TemplateEdges& kind,
                                                       const Template& geometry, const EdgePolygons& polygons,
                                                       const MeshFineness& fineness);

}  // namespace meso::brep
