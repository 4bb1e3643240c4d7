// SPDX-License-Identifier: Apache-2.0
#pragma once
// Indexed triangles, the common shape of everything that is meshed, read from STL or drawn.

#include <array>
#include <cstdint>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso {

/// Points in millimetres; triangles counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace meso
