// SPDX-License-Identifier: Apache-2.0
#include "lattice/template_mesh.hpp"

namespace meso::brep {

void mesh_alike(const std::vector<TemplateEdges>&, const MeshFineness&) {}

}  // namespace meso::brep
