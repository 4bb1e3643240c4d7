// SPDX-License-Identifier: Apache-2.0
#pragma once
// P(q) = p backwards, as terms of the point: what conformal mapping and volume elements need. Private.
//
//   system of axes                                     inverse
//   three linear ones                                  a matrix
//   one circular, a linear one along it, a distance    cylinder, or cone if the distance is oblique
//   one circular, two distances in a plane with it     cylinder whose second length is a distance
//   two circular at right angles, a distance           sphere

#include <array>
#include <optional>

#include "meso/eval/coordinates.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

struct Coordinate {
  Term q;            ///< angles within half a turn of `around`
  Term millimeters;  ///< how long a unit of q is at the point, at least
  bool is_angle = false;
};

/// Of the system's first three axes `axes`, the others' coordinates being 0. `around`: angles are given within half a
/// turn of these. Nothing where no inverse is known.
[[nodiscard]] std::optional<std::array<Coordinate, 3>> coordinates_of(const eval::CoordinateFrame& system,
                                                                      const std::array<std::size_t, 3>& axes,
                                                                      const std::array<double, 3>& around);

}  // namespace meso::implicit
