// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

namespace meso::operations {

/// By the name: triangles as they are, not a body that would have to be made or tessellated. Also .vtk, which is only
/// written: reading it is refused as what it is.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);

}  // namespace meso::operations
