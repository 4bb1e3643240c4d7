// SPDX-License-Identifier: Apache-2.0
#pragma once
// Mesh files of any size, written block by block (see mesh_sink.hpp).
//
//   std::optional<OutputFile> file = OutputFile::create("part.ply", ExistingFile::replace, diagnostics);
//   const std::unique_ptr<MeshSink> writer = make_mesh_writer(MeshFormat::ply, file);
//   if (contour(*source, *writer, {}, run, diagnostics) && file.commit(diagnostics)) ...
//
// Equal meshes give equal bytes. A file that failed says so at OutputFile::commit().

#include <memory>
#include <optional>
#include <string_view>

#include "meso/base/mesh_sink.hpp"
#include "meso/base/output_file.hpp"

namespace meso {

enum class MeshFormat { ply, ply_double };

/// `file` must outlive the writer.
[[nodiscard]] std::unique_ptr<MeshSink> make_mesh_writer(MeshFormat format, OutputFile& file);

}  // namespace meso
