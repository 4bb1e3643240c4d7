// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles that arrive in blocks, so that a mesh of a hundred million needs no vector.

#include <array>
#include <functional>
#include <span>

#include "meso/base/triangle_mesh.hpp"

namespace meso {

/// Corners counter-clockwise seen from outside, millimetres.
using Triangle = std::array<Vec3, 3>;
using TriangleBlockCallback = std::function<void(std::span<const Triangle>)>;

/// Calls back every triangle, block by block, always in the same order. May be called more than once.
using TriangleStream = std::function<void(const TriangleBlockCallback&)>;

/// The triangles of an indexed mesh. `mesh` must outlive the stream.
[[nodiscard]] TriangleStream triangles_of(const TriangleMesh& mesh);

}  // namespace meso
