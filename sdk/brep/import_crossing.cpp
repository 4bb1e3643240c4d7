// SPDX-License-Identifier: Apache-2.0
#include "import_crossing.hpp"

#include <algorithm>
#include <vector>

#include "boolean.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/mesh/self_contact.hpp"
#include "shape_to_body.hpp"

namespace meso::brep {
namespace {

constexpr double relative_deflection = 1e-3, again = 0.25;

std::optional<Vec3> crossing_of_triangles(const TopoDS_Shape& solid, double deflection) {
  DiagnosticSink of_mesh;
  const TopoDS_Shape copy = BRepBuilderAPI_Copy(solid, false, false).Shape();  // triangles of its own
  const auto body = shape_to_body(copy, {.mesh = MeshTolerance{.deflection_mm = deflection}}, of_mesh);
  if (!body) return {};
  const TriangleMesh mesh = triangle_mesh(*body);
  // Meshers keep a deflection between points of a face, not everywhere.
  const std::vector<double> heights(mesh.triangles.size(), 2 * deflection);
  const SelfContacts contacts = count_self_contacts(mesh, heights, 1000, SharedPoint::tested);
  return contacts.deep > 0 ? contacts.place : std::nullopt;
}

}  // namespace

std::optional<Vec3> self_crossing(const TopoDS_Shape& solid) {
  const Box3 box = box_of(solid);
  const double deflection = relative_deflection * norm(box.max - box.min);
  return crossing_of_triangles(solid, deflection) ? crossing_of_triangles(solid, again * deflection) : std::nullopt;
}

}  // namespace meso::brep
