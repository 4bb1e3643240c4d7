// SPDX-License-Identifier: Apache-2.0
#pragma once
// Mesh files of any size, written block by block (see mesh_sink.hpp).
//
//   std::optional<OutputFile> file = OutputFile::create("part.ply", ExistingFile::replace, diagnostics);
//   const std::unique_ptr<MeshSink> writer = make_mesh_writer(MeshFormat::ply, *file);
//   if (contour(*source, *writer, {}, run, diagnostics) && file->commit(diagnostics)) ...
//
// Coordinates are 32-bit floats or, where it is asked for, doubles (not of STL, whose binary form has floats only).
// Text has the shortest numbers that read back as the same float or double. All but the STL formats, which have no
// shared points, take constant memory; 3MF is compressed at the end, out of a temporary file. A file that failed says
// so at OutputFile::commit(); formats that count ahead (all but OBJ and ASCII STL) cannot be written to a pipe. Equal
// meshes give equal bytes, however they are cut into blocks.

#include <memory>
#include <optional>
#include <string_view>

#include "meso/base/mesh_sink.hpp"
#include "meso/base/output_file.hpp"

namespace meso {

enum class MeshFormat { ply, stl, stl_ascii, obj, off, vtk, threemf };
enum class Coordinates { as_float, as_double };

/// ".stl .3mf .ply .obj .off .vtk", for messages; .3mf where the library is built with libzip.
[[nodiscard]] std::string_view mesh_extensions();

/// By the ending of a file's name, upper or lower case: one of mesh_extensions().
[[nodiscard]] std::optional<MeshFormat> mesh_format_of(std::string_view path);

[[nodiscard]] constexpr bool can_hold_doubles(MeshFormat format) {
  return format != MeshFormat::stl && format != MeshFormat::stl_ascii;
}

/// `file` must outlive the writer. REQUIRES: doubles only where the format can hold them.
[[nodiscard]] std::unique_ptr<MeshSink> make_mesh_writer(MeshFormat format, OutputFile& file,
                                                         Coordinates coordinates = Coordinates::as_float);

}  // namespace meso
