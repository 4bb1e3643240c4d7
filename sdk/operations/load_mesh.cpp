// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/load_mesh.hpp"

#include <algorithm>
#include <iterator>

#include "file_extension.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "read_mesh.hpp"

namespace meso::operations {

bool is_mesh_file(const std::filesystem::path& file) {
  static constexpr std::string_view extensions[] = {".stl", ".ply", ".obj", ".off", ".vtk", ".3mf"};
  return std::ranges::find(extensions, lower_extension(file)) != std::end(extensions);
}

std::optional<TriangleMesh> load_mesh(const std::filesystem::path& file, MakeOptions options, DiagnosticSink& sink) {
  if (is_mesh_file(file)) return read_surface_mesh_file(file, sink, options.run);
  if (brep::is_exact_file(file)) {
    const auto body = brep::read_step(
        file, {.deflection_mm = options.deflection_mm.value_or(0.1), .angle_rad = options.angle_rad.value_or(0.3)},
        options.run, sink);
    return body ? std::optional(brep::triangle_mesh(*body)) : std::nullopt;
  }
  options.mesh = true;
  const auto made = make_body(file, options, sink);
  return made ? std::optional(brep::triangle_mesh(made->realisation.body)) : std::nullopt;
}

}  // namespace meso::operations
