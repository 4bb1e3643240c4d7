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

Box3 with_room(const Box3& region) {
  Box3 box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = region.max[a] - region.min[a];
    const double digits = std::floor(std::log10(size)) - 1, step = std::pow(10, std::abs(digits));
    const auto rounded = [&](double steps) { return digits < 0 ? steps / step : steps * step; };
    const auto in_steps = [&](double v) { return digits < 0 ? v * step : v / step; };
    box.min[a] = rounded(std::floor(in_steps(region.min[a])) - 1);
    box.max[a] = rounded(std::ceil(in_steps(region.max[a])) + 1);
  }
  return box;
}

bool holds(const Box3& outer, const Box3& inner) {
  for (std::size_t a = 0; a < 3; ++a)
    if (!(outer.min[a] <= inner.min[a] && outer.max[a] >= inner.max[a])) return false;
  return true;
}

}  // namespace meso::sdf
