// SPDX-License-Identifier: Apache-2.0
// Gmsh 4.1, binary. One volume and up to seven surfaces are entities, each in a physical group of its own.

#include <algorithm>
#include <string>

#include "formats.hpp"
#include "sides.hpp"

namespace meso {
namespace {

constexpr std::int32_t triangle_type = 2, tet_type = 4, volume_tag = 1;

struct Surface {
  std::int32_t tag;
  std::string_view name;
  std::span<const TetMesh::Face> faces;
};

std::vector<Surface> surfaces_of(const TetMesh& mesh) {
  std::vector<Surface> out;
  for (std::size_t s = 0; s < TetMesh::side_count; ++s)
    if (const auto faces = faces_of(mesh, static_cast<TetMesh::Side>(s)); !faces.empty())
      out.push_back({static_cast<std::int32_t>(s) + 1, TetMesh::side_names[s], faces});
  return out;
}

void write_names(const std::vector<Surface>& surfaces, Chunked& out) {
  out.text("$PhysicalNames\n" + std::to_string(surfaces.size() + 1) + "\n");
  for (const Surface& s : surfaces) out.text("2 " + std::to_string(s.tag) + " \"" + std::string(s.name) + "\"\n");
  out.text("3 1 \"solid\"\n$EndPhysicalNames\n");
}

Box3 box_of(const TetMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.points) box.extend(p);
  return box.empty() ? Box3{{}, {}} : box;
}

/// Tag, box, physical group, bounding entities: of which the file knows none.
void write_entity(std::int32_t tag, const Box3& box, Chunked& out) {
  out.raw(tag);
  out.raw(box.min);
  out.raw(box.max);
  out.raw(std::uint64_t{1});
  out.raw(tag);
}

void write_entities(const TetMesh& mesh, const std::vector<Surface>& surfaces, Chunked& out) {
  const Box3 box = box_of(mesh);
  out.text("$Entities\n");
  for (const std::uint64_t count :
       {std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{surfaces.size()}, std::uint64_t{1}})
    out.raw(count);
  for (const Surface& s : surfaces) {
    write_entity(s.tag, box, out);
    out.raw(std::uint64_t{0});
  }
  write_entity(volume_tag, box, out);
  out.raw(std::uint64_t{surfaces.size()});
  for (const Surface& s : surfaces) out.raw(s.tag);
  out.text("\n$EndEntities\n");
}

void write_nodes(const TetMesh& mesh, Chunked& out) {
  const std::uint64_t n = mesh.points.size();
  out.text("$Nodes\n");
  for (const std::uint64_t v : {std::uint64_t{1}, n, std::min<std::uint64_t>(n, 1), n}) out.raw(v);
  for (const std::int32_t v : {3, volume_tag, 0}) out.raw(v);
  out.raw(n);
  for (std::uint64_t i = 1; i <= n; ++i) out.raw(i);
  for (const Vec3& p : mesh.points) out.raw(p);
  out.text("\n$EndNodes\n");
}

void write_elements(const TetMesh& mesh, const std::vector<Surface>& surfaces, Chunked& out) {
  std::uint64_t total = mesh.tets.size(), tag = 0;
  for (const Surface& s : surfaces) total += s.faces.size();
  const auto write = [&](const auto& corners) {
    out.raw(++tag);
    for (const std::uint32_t c : corners) out.raw(std::uint64_t{c} + 1);
  };
  out.text("$Elements\n");
  for (const std::uint64_t v : {std::uint64_t{surfaces.size() + 1}, total, std::min<std::uint64_t>(total, 1), total})
    out.raw(v);
  for (const Surface& s : surfaces) {
    for (const std::int32_t v : {2, s.tag, triangle_type}) out.raw(v);
    out.raw(std::uint64_t{s.faces.size()});
    for (const TetMesh::Face& f : s.faces) write(mesh.corners(f));
  }
  for (const std::int32_t v : {3, volume_tag, tet_type}) out.raw(v);
  out.raw(std::uint64_t{mesh.tets.size()});
  for (const auto& t : mesh.tets) write(t);
  out.text("\n$EndElements\n");
}

}  // namespace

void write_msh(const TetMesh& mesh, Chunked& out) {
  const std::vector<Surface> surfaces = surfaces_of(mesh);
  out.text("$MeshFormat\n4.1 1 8\n");
  out.raw(std::int32_t{1});
  out.text("\n$EndMeshFormat\n");
  write_names(surfaces, out);
  write_entities(mesh, surfaces, out);
  write_nodes(mesh, out);
  write_elements(mesh, surfaces, out);
}

}  // namespace meso
