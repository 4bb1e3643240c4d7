// SPDX-License-Identifier: Apache-2.0
#include "meso/base/triangle_stream.hpp"

namespace meso {

TriangleStream triangles_of(const TriangleMesh& mesh) {
  return [&mesh](const TriangleBlockCallback& callback) {
    std::array<Triangle, 1024> block;
    std::size_t filled = 0;
    for (const auto& t : mesh.triangles) {
      block[filled++] = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
      if (filled == block.size()) {
        callback(block);
        filled = 0;
      }
    }
    if (filled > 0) callback(std::span(block).first(filled));
  };
}

}  // namespace meso
