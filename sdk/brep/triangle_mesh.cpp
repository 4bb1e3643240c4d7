// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/triangle_mesh.hpp"

#include <utility>

#include "meso/brep/triangles.hpp"
#include "meso/import_surface_mesh/weld.hpp"

namespace meso::brep {

TriangleMesh triangle_mesh(const Body& body) {
  Weld weld;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) weld.add(t[0], t[1], t[2]);
  });
  return std::move(weld).mesh();
}

}  // namespace meso::brep
