// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/grid.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit {

std::array<std::int32_t, 3> nodes_for_total(const Box3& box, double total) {
  const Vec3 size = box.max - box.min;
  const double per_length = std::cbrt(total / (size.x * size.y * size.z));
  std::array<std::int32_t, 3> nodes{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    nodes[axis] = static_cast<std::int32_t>(std::clamp(std::round(size[axis] * per_length), 2.0, 2147483647.0));
  return nodes;
}

}  // namespace meso::implicit
