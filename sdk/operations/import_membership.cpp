// SPDX-License-Identifier: Apache-2.0
#include "import_membership.hpp"

#include <algorithm>
#include <memory>

#include "file_extension.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/membership/crossings.hpp"
#include "meso/operations/convert.hpp"

namespace meso::operations {
namespace {

constexpr double relative_deflection = 2e-4;  ///< of an imported body's diagonal

bool has_flat_faces_only(const brep::Body& body) {
  return std::ranges::all_of(body.solids, [](const brep::Solid& solid) {
    return std::ranges::all_of(solid.outer.geometry->faces, [](const brep::FaceTemplate& face) {
      return std::holds_alternative<brep::Plane>(face.surface);
    });
  });
}

}  // namespace

std::optional<membership::ImportedSolid> ImportedBodies::read(const eval::ImportShape& import) {
  const auto [found, fresh] = known_.try_emplace(import.file.name());
  if (fresh) {
    if (const auto mesh = triangles(import)) {
      const auto solid = std::make_shared<const membership::TriangleSolid>(*mesh);
      found->second = {solid->box(), [solid](Vec3 p) { return solid->contains(p); }};
    }
  }
  return found->second;
}

std::optional<TriangleMesh> ImportedBodies::triangles(const eval::ImportShape& import) {
  if (lower_extension(import.file.name()) == ".stl") return read_surface_mesh_file(import.file, sink_, run_);
  const auto body =
      brep::read_step(import.file, {.relative_deflection = relative_deflection, .angle_rad = 0.1}, run_, sink_);
  if (!body) return {};
  if (!has_flat_faces_only(*body)) {
    const brep::Measures m = brep::measure(*body);
    const double scale = import.scale * std::cbrt(std::abs(determinant(import.transform.linear))),
                 error = relative_deflection * norm(m.box.max - m.box.min);
    error_mm_ = std::max(error_mm_, scale * error);
    error_mm3_ += scale * scale * scale * error * m.area;
  }
  return brep::triangle_mesh(*body);
}

}  // namespace meso::operations
