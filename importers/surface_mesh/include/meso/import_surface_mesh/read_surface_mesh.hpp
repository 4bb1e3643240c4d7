// SPDX-License-Identifier: Apache-2.0
#pragma once
// Reads a surface mesh: STL, PLY, OBJ or OFF, strictly.
//
//   std::optional<TriangleMesh> mesh = read_surface_mesh_file("bunny.ply", sink);
//
// What a file is, its first bytes say ("ply", "OFF", "solid", the size of binary STL); where they do not, the name's
// extension does. PLY: ASCII and binary of both byte orders, any further elements and properties. OBJ: v and f, with
// texture and normal indices, negative indices and continued lines; everything else is passed over. OFF: also COFF,
// NOFF, STOFF and their mixtures, with comments. Polygons are parted into triangles (quadrilaterals along the diagonal
// inside, larger ones by cutting ears). Points stay as the file lists them, in its unit; STL has none, so that equal
// corners become one point there.
//
// Errors, each with the line or the byte: MESH_FILE_SYNTAX, MESH_FILE_TRUNCATED, MESH_FILE_INDEX, MESH_FILE_NOT_FINITE,
// MESH_FILE_UNSUPPORTED, MESH_FILE_FORMAT, MESH_FILE_EMPTY, those of read_stl, FILE_NOT_FOUND. Counts are compared with
// the file's size before memory is taken. Cost: a million triangles take 0.1 s in binary PLY, 0.35 s in any text.
// Thread rule: pure.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/resource/resource.hpp"

namespace meso {

/// `file` names the bytes in diagnostics, and its extension helps where they are ambiguous.
[[nodiscard]] std::optional<TriangleMesh> read_surface_mesh(std::string_view bytes, const std::string& file,
                                                            DiagnosticSink& sink);
/// A file may take a quarter of the memory budget: FILE_TOO_LARGE. LIMIT_TIME, CANCELLED.
[[nodiscard]] std::optional<TriangleMesh> read_surface_mesh_file(const Resource& file, DiagnosticSink& sink,
                                                                 const RunOptions& run = {});

}  // namespace meso
