// SPDX-License-Identifier: Apache-2.0
#include "region.hpp"

#include <algorithm>
#include <cmath>

namespace meso::sdf {

Box3 before(const Instruction& instruction, const Box3& region) {
  const Vec3 v{instruction.numbers[0], instruction.numbers[1], instruction.numbers[2]};
  if (instruction.verb == Verb::move) return {region.min - v, region.max - v};
  if (instruction.verb == Verb::scale) {
    Box3 box;
    for (std::size_t a = 0; a < 3; ++a) {
      const double one = region.min[a] / v[a], other = region.max[a] / v[a];
      box.min[a] = std::min(one, other);
      box.max[a] = std::max(one, other);
    }
    return box;
  }
  // Turns leave the distance from the origin.
  double reach = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double farthest = std::max(std::abs(region.min[a]), std::abs(region.max[a]));
    reach += farthest * farthest;
  }
  reach = std::sqrt(reach);
  return {{-reach, -reach, -reach}, {reach, reach, reach}};
}

bool holds(const Box3& outer, const Box3& inner) {
  for (std::size_t a = 0; a < 3; ++a)
    if (!(outer.min[a] <= inner.min[a] && outer.max[a] >= inner.max[a])) return false;
  return true;
}

}  // namespace meso::sdf
