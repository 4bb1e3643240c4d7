// SPDX-License-Identifier: Apache-2.0
#include "meso/export_tetra_mesh/write_tet_mesh.hpp"

#include <algorithm>
#include <string>

#include "formats.hpp"
#include "sides.hpp"

namespace meso {

std::span<const TetMesh::Face> faces_of(const TetMesh& mesh, TetMesh::Side side) {
  const auto [first, last] =
      std::equal_range(mesh.boundary.begin(), mesh.boundary.end(), TetMesh::Face{.side = side},
                       [](const TetMesh::Face& a, const TetMesh::Face& b) { return a.side < b.side; });
  return {first, last};
}

std::vector<std::uint32_t> points_of(const TetMesh& mesh, std::span<const TetMesh::Face> faces) {
  std::vector<std::uint32_t> points;
  for (const TetMesh::Face& f : faces)
    for (const std::uint32_t p : mesh.corners(f)) points.push_back(p);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::optional<TetFormat> tet_format_of(std::string_view path) {
  if (path.size() < 4) return std::nullopt;
  std::string ending(path.substr(path.size() - 4));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".vtu") return TetFormat::vtu;
  if (ending == ".msh") return TetFormat::msh;
  if (ending == ".inp") return TetFormat::inp;
  return std::nullopt;
}

bool write_tet_mesh(const TetMesh& mesh, TetFormat format, ByteSink& file, const RunOptions& run,
                    DiagnosticSink& sink) {
  run.report("writing", 0);
  Chunked out(file, run, sink);
  switch (format) {
    case TetFormat::vtu:
      write_vtu(mesh, out);
      break;
    case TetFormat::vtu_ascii:
      write_vtu_ascii(mesh, out);
      break;
    case TetFormat::msh:
      write_msh(mesh, out);
      break;
    case TetFormat::inp:
      write_inp(mesh, out);
      break;
  }
  return out.finish();
}

}  // namespace meso
