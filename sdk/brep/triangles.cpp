// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/triangles.hpp"

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {

void visit_triangles(const Body& body, const TriangleBlockCallback& callback) {
  std::vector<Vec3> points;
  std::vector<Triangle> block;
  const auto visit_shell = [&](const Shell& shell) {
    const Template& geometry = *shell.geometry;
    shell.visit([&](const FaceInstance& instance) {
      const Triangulation& mesh = geometry.faces[instance.face].mesh;
      points.clear();
      block.clear();
      // Integers are added before anything is rounded: two faces that name a point from two cells get the same bits.
      for (const MeshPoint& p : mesh.points)
        points.push_back(shell.placement * (p.point + cell_origin(geometry, instance.cell + p.offset)));
      for (const auto& t : mesh.triangles) block.push_back({points[t[0]], points[t[1]], points[t[2]]});
      callback(block);
    });
  };
  for (const Solid& solid : body.solids) {
    visit_shell(solid.outer);
    for (const Shell& hollow : solid.voids) visit_shell(hollow);
  }
}

TriangleStream triangles_of(const Body& body) {
  return [&body](const TriangleBlockCallback& callback) { visit_triangles(body, callback); };
}

}  // namespace meso::brep
