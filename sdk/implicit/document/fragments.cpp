// SPDX-License-Identifier: Apache-2.0
#include "fragments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/mesh_distance/mesh_field.hpp"

namespace meso::implicit {
namespace {

std::optional<TriangleMesh> mesh_of(const Field& field, double spacing, const RunOptions& run, DiagnosticSink& sink) {
  TriangleMesh mesh;
  Grid grid{.box = field.bounds()};
  if (grid.box.empty()) return mesh;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cells = std::ceil((grid.box.max[a] - grid.box.min[a]) / spacing);
    grid.nodes[a] = static_cast<std::int32_t>(std::clamp(cells + 1, 2.0, 2e9));
  }
  if (!check_grid(grid, run, sink)) return std::nullopt;
  const auto source = compile(field.term(), grid, {}, run, sink);
  MemoryMeshSink into(mesh);
  if (!source || !contour(*source, into, {}, run, sink)) return std::nullopt;
  return mesh;
}

/// Triangles that share points. Those around solids enclose a positive volume, those around cavities a negative one.
struct Shells {
  std::vector<std::uint32_t> of_point;
  std::vector<double> volumes;
};

Shells shells_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const auto& t : mesh.triangles) {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  Shells shells{std::vector<std::uint32_t>(mesh.points.size()), {}};
  constexpr auto unnumbered = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(mesh.points.size(), unnumbered);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    std::uint32_t& n = number[root(p)];
    if (n == unnumbered) {
      n = static_cast<std::uint32_t>(shells.volumes.size());
      shells.volumes.push_back(0);
    }
    shells.of_point[p] = n;
  }
  for (const auto& t : mesh.triangles)
    shells.volumes[shells.of_point[t[0]]] += dot(mesh.points[t[0]], cross(mesh.points[t[1]], mesh.points[t[2]])) / 6;
  return shells;
}

TriangleMesh part_of(const TriangleMesh& mesh, const Shells& shells, const std::vector<bool>& taken) {
  TriangleMesh result{mesh.points, {}};
  for (const auto& t : mesh.triangles)
    if (taken[shells.of_point[t[0]]]) result.triangles.push_back(t);
  return result;
}

std::shared_ptr<const MeshField> distance_to(const TriangleMesh& mesh, const RunOptions& run, DiagnosticSink& sink) {
  return MeshField::make(mesh, "fragments", run, sink);
}

/// The distances to the solids of a body, one by one; none is needed if there is only one.
std::optional<std::vector<std::shared_ptr<const MeshField>>> solids_of(const Field& body, double spacing,
                                                                       const RunOptions& run, DiagnosticSink& sink) {
  const auto mesh = mesh_of(body, spacing, run, sink);
  if (!mesh) return std::nullopt;
  const Shells shells = shells_of(*mesh);
  std::vector<std::shared_ptr<const MeshField>> result;
  if (std::ranges::count_if(shells.volumes, [](double v) { return v > 0; }) < 2) return result;
  for (std::size_t s = 0; s < shells.volumes.size(); ++s) {
    if (shells.volumes[s] <= 0) continue;
    std::vector<bool> taken(shells.volumes.size(), false);
    taken[s] = true;
    auto distance = distance_to(part_of(*mesh, shells, taken), run, sink);
    if (!distance) return std::nullopt;
    result.push_back(std::move(distance));
  }
  return result;
}

}  // namespace

std::optional<Fragments> fragments_of(const Field& body, const Field& before, double spacing, const RunOptions& run,
                                      DiagnosticSink& sink) {
  const auto mesh = mesh_of(body, spacing, run, sink);
  const auto solids = mesh ? solids_of(before, spacing, run, sink) : std::nullopt;
  if (!solids) return std::nullopt;
  const Shells shells = shells_of(*mesh);
  std::vector<std::size_t> some_point(shells.volumes.size());
  for (std::size_t p = 0; p < mesh->points.size(); ++p) some_point[shells.of_point[p]] = p;

  // Of each solid, the largest piece stays.
  std::vector<std::optional<std::size_t>> largest(std::max<std::size_t>(1, solids->size()));
  std::vector<bool> is_loose(shells.volumes.size(), false);
  for (std::size_t s = 0; s < shells.volumes.size(); ++s) {
    if (shells.volumes[s] <= 0) continue;
    std::size_t solid = 0;
    for (std::size_t n = 1; n < solids->size(); ++n) {
      const Vec3 p = mesh->points[some_point[s]];
      if ((*solids)[n]->value(p) < (*solids)[solid]->value(p)) solid = n;
    }
    std::size_t loose = s;
    if (!largest[solid]) {
      largest[solid] = s;
      continue;
    }
    if (shells.volumes[s] > shells.volumes[*largest[solid]]) std::swap(loose, *largest[solid]);
    is_loose[loose] = true;
  }
  Fragments result;
  const double cell = spacing * spacing * spacing;
  for (std::size_t s = 0; s < shells.volumes.size(); ++s) result.count += is_loose[s] && shells.volumes[s] >= cell;
  if (std::ranges::none_of(is_loose, [](bool loose) { return loose; })) return result;
  const auto pieces = distance_to(part_of(*mesh, shells, is_loose), run, sink);
  if (!pieces) return std::nullopt;
  result.pieces = Field::external(pieces);
  return result;
}

}  // namespace meso::implicit
