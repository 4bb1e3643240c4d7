// SPDX-License-Identifier: Apache-2.0
#pragma once
// The point that is nearest to several planes: where the sheets of a surface meet.

#include <span>

#include "meso/base/vec.hpp"

namespace meso::implicit {

/// normal * (p - at) + value = 0.
struct Plane {
  Vec3 at, normal;  ///< unit length
  double value = 0;
};

/// The least sum of squared distances to the planes, by their quadratic error function (Kobbelt et al. 2001). Where the
/// planes leave a direction open - along an edge, in a plane - the point that is nearest to `start` there.
/// `least_share`: of the largest eigenvalue; directions with less are open.
[[nodiscard]] Vec3 nearest_to_planes(std::span<const Plane> planes, Vec3 start, double least_share);

}  // namespace meso::implicit
