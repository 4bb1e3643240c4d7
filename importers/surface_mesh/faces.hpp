// SPDX-License-Identifier: Apache-2.0
#pragma once
// Polygons as files list them, and the triangles they are made of.

#include "meso/base/triangle_mesh.hpp"

namespace meso {

struct Faces {
  std::vector<std::uint32_t> corners;  // of all faces, one after the other
  std::vector<std::uint32_t> sizes;    // corners of each face, at least 3
};

/// Triangles are taken as they are, quadrilaterals parted along the diagonal that lies inside (the shorter one if both
/// do), polygons of up to 1000 corners by cutting ears in the plane that fits best, larger and self-crossing ones as
/// fans. REQUIRES: corners refer to points that exist.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of(const Faces& faces,
                                                                     const std::vector<Vec3>& points);

}  // namespace meso
