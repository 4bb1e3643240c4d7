// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangulates the solids of all kinds of cells so that edges that are one modulo the lattice get the same points.
// Private.

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

/// Leaves a triangulation on every face. Throws Standard_Failure.
void mesh_alike(const std::vector<TemplateEdges>& kinds, const MeshFineness& fineness);

}  // namespace meso::brep
