// SPDX-License-Identifier: Apache-2.0
// A ball with the walls of a gyroid, from a field to a mesh file.
//
// usage: contour_gyroid FILE.ply

#include <iostream>

#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/field.hpp"

using namespace meso;
using namespace meso::implicit;

bool write_part(const char* path, DiagnosticSink& sink) {
  // begin: ten lines
  const std::optional<Field> gyroid = Field::surface("gyroid", sink);
  if (!gyroid) return false;
  const Field part = intersection_of(Field::ball(10), gyroid->scaled(5).shell(2));
  const Grid grid{.box = part.bounds(), .nodes = nodes_for_total(part.bounds(), 1e6)};
  std::optional<OutputFile> file = OutputFile::create(path, ExistingFile::replace, sink);
  if (!file) return false;
  const auto writer = make_mesh_writer(MeshFormat::ply, *file);
  const auto report = contour(*compile(part.term(), grid), *writer, {}, {}, sink);
  if (!report || !file->commit(sink)) return false;
  std::cout << report->triangles << " triangles, Euler characteristic " << report->euler << '\n';
  // end: ten lines
  return true;
}

int main(int argc, char** argv) {
  DiagnosticSink sink;
  if (argc == 2 && write_part(argv[1], sink)) return 0;
  for (const Diagnostic& d : sink.diagnostics()) std::cerr << render(d) << '\n';
  return 1;
}
