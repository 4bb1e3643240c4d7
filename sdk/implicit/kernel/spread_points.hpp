// SPDX-License-Identifier: Apache-2.0
#pragma once
// A few points of a box, evenly spread for any number of them: an additive recurrence with the powers of the root of
// t^4 = t + 1.

#include <array>
#include <cmath>

#include "meso/base/vec.hpp"

namespace meso::implicit {

template <std::size_t count>
[[nodiscard]] std::array<Vec3, count> spread_points(const Box3& box) {
  constexpr std::array<double, 3> step = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  std::array<Vec3, count> points;
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double t = 0.5 + step[axis] * static_cast<double>(p + 1);
      points[p][axis] = box.min[axis] + (t - std::floor(t)) * (box.max[axis] - box.min[axis]);
    }
  return points;
}

}  // namespace meso::implicit
