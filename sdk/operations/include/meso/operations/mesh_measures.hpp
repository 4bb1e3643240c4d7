// SPDX-License-Identifier: Apache-2.0
#pragma once
// Numbers that describe a triangle mesh. Millimetres.

#include <cstdint>

#include "meso/base/vec.hpp"

namespace meso::operations {

struct MeshMeasures {
  double volume = 0, area = 0;
  std::uint64_t points = 0, triangles = 0;
  // Shells are triangles that share points. One around a piece of the solid encloses a positive volume, one around a
  // cavity a negative one.
  std::uint64_t components = 0;  ///< pieces of the solid
  std::uint64_t cavities = 0;    ///< hollows within them that nothing connects with the outside
  double cavity_volume = 0;      ///< of all of them
  std::uint64_t crumbs = 0;      ///< shells of either kind too small to count among these
  /// Every edge is run through as often in one direction as in the other; wrong with a chance of 2^-64.
  bool closed = false;
  std::int64_t euler = 0;  ///< points - edges + triangles, three edges for two triangles
  Box3 box;                ///< empty without points
};

}  // namespace meso::operations
