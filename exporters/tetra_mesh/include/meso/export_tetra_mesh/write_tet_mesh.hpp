// SPDX-License-Identifier: Apache-2.0
#pragma once
// Tetrahedra as the file that a solver or a viewer reads: VTU, Gmsh MSH 4.1, Abaqus and CalculiX INP.
//
//   auto file = OutputFile::create("part.inp", ExistingFile::replace, sink);
//   if (file && write_tet_mesh(mesh, TetFormat::inp, *file, run, sink)) (void)file->commit(sink);
//
// VTU: binary appended (raw, 64-bit headers) or text. MSH: binary; the solid and the sides of its boundary are physical
// groups. INP: nodes, C3D4 elements in the set SOLID, and for each side of the boundary a node set NAME, an element set
// and a surface S_NAME; a file to be included, without material or steps. Numbers in text are the shortest that read
// back as the same double; of INP, whose fields hold 20 characters, they have 13 digits. Sides without faces are left
// out. Equal meshes give equal bytes.
//
// Streams: constant memory beside the mesh, and a node list for each side. False: stopped (LIMIT_TIME, CANCELLED), or
// the file failed, which OutputFile::commit() reports.

#include <optional>
#include <string_view>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/tet_mesh.hpp"

namespace meso {

enum class TetFormat { vtu, vtu_ascii, msh, inp };

/// By the ending of a file's name, upper or lower case: .vtu .msh .inp.
[[nodiscard]] std::optional<TetFormat> tet_format_of(std::string_view path);

[[nodiscard]] bool write_tet_mesh(const TetMesh& mesh, TetFormat format, ByteSink& file, const RunOptions& run,
                                  DiagnosticSink& sink);

}  // namespace meso
