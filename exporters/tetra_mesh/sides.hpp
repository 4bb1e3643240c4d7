// SPDX-License-Identifier: Apache-2.0
#pragma once
// The boundary of a mesh, side by side. Private.

#include <span>
#include <vector>

#include "meso/base/tet_mesh.hpp"

namespace meso {

/// The faces of one side: the boundary is sorted by them.
[[nodiscard]] std::span<const TetMesh::Face> faces_of(const TetMesh& mesh, TetMesh::Side side);
/// Points of these faces, ascending, each once.
[[nodiscard]] std::vector<std::uint32_t> points_of(const TetMesh& mesh, std::span<const TetMesh::Face> faces);

}  // namespace meso
