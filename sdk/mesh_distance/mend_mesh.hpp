// SPDX-License-Identifier: Apache-2.0
#pragma once
// For a mesh that is not closed: what is wrong, and the part of it that can be put right without moving a point.

#include <vector>

#include "meso/mesh_distance/mesh_quality.hpp"
#include "spatial_order.hpp"

namespace meso::implicit {

/// Leaves out triangles that are there twice if that makes the mesh more nearly closed, and turns over the minority (by
/// area) of each connected piece whose triangles can be made to agree. Returns which of `order` to turn, and fills what
/// `quality` says about edges. `keys` are those of the points (point_keys.hpp).
[[nodiscard]] std::vector<bool> mend_mesh(std::vector<Placed>& order, const TriangleMesh& mesh,
                                          const std::vector<std::uint64_t>& keys, MeshQuality& quality);

}  // namespace meso::implicit
