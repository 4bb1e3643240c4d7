// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso::operations {

/// The whole file, then read_stl. A missing file is FILE_NOT_FOUND.
[[nodiscard]] std::optional<TriangleMesh> read_stl_file(const std::filesystem::path& file, DiagnosticSink& sink);

}  // namespace meso::operations
