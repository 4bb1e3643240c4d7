// SPDX-License-Identifier: Apache-2.0
#include "density_spacing.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"

namespace meso::implicit {

double spacing_for_share(const Term& body, const Box3& box, double share) {
  constexpr std::int32_t along = 64;
  // Between surfaces that err to both sides, an error may vanish that is there elsewhere; nothing shows finer than a
  // thousandth of its cell.
  constexpr double least = 1.0 / 1000, most = 1.0 / 8;
  const Grid grid{.box = box, .nodes = {along + 1, along + 1, along + 1}};
  DiagnosticSink told;
  const auto source = compile(body, grid, {}, {.jobs = 1}, told);
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  if (!source || !contour(*source, sink, {}, {.jobs = 1}, told)) return HUGE_VAL;
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.points[a] - box.min, cross(mesh.points[b] - box.min, mesh.points[c] - box.min)) / 6;
  const Vec3 size = box.max - box.min;
  const double error = std::fabs(volume / (share * size.x * size.y * size.z) - 1);
  if (!std::isfinite(error)) return HUGE_VAL;
  return std::clamp(std::sqrt(density_error / error) / along, least, most);
}

}  // namespace meso::implicit
