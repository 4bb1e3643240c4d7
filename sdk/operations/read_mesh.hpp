// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso::operations {

/// By the name: triangles as they are, not a body that would have to be made or tessellated. Also .vtk, which is only
/// written: reading it is refused as what it is.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);
/// Triangles of such a file.
[[nodiscard]] std::optional<TriangleMesh> read_mesh_file(const std::filesystem::path& file, DiagnosticSink& sink);

/// The whole file, then read_stl. A missing file is FILE_NOT_FOUND.
[[nodiscard]] std::optional<TriangleMesh> read_stl_file(const std::filesystem::path& file, DiagnosticSink& sink);

}  // namespace meso::operations
