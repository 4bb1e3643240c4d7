// SPDX-License-Identifier: Apache-2.0
#pragma once
// How close a mesh came to the surface of its field, and what that took.

#include <cstdint>

namespace meso::operations {

struct MeshAccuracy {
  /// The largest distance to the surface of the field that was found at points of the mesh, and of creases from
  /// the mesh. In the units of the coordinates.
  double distance = 0;
  std::uint64_t grid_samples = 0;     ///< on all grids that were tried
  std::uint64_t surface_samples = 0;  ///< single values of the field, asked for beside the surface
};

}  // namespace meso::operations
