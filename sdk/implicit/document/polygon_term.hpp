// SPDX-License-Identifier: Apache-2.0
#pragma once
// The distance to a profile that is extruded or turned. Private.

#include <span>
#include <utility>

#include "meso/base/polygon.hpp"
#include "meso/eval/shape.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

struct Side {
  Point2 from, to;
  friend auto operator<=>(const Side&, const Side&) = default;
};

/// Of the closed polygons, in any order, that `sides` make up: inside is what an odd number of them is around. Exact in
/// the plane of the profile and along z.
[[nodiscard]] Field extrusion(std::span<const Side> sides, double z, double height);
[[nodiscard]] Field extrusion(const eval::ExtrusionShape& shape);
/// Exact: what is nearest to a point stands in its half plane.
[[nodiscard]] Field revolution(const eval::RevolutionShape& shape);

}  // namespace meso::implicit
