// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where two or three sheets of a surface meet, seen from a point of each.

#include <array>
#include <span>

#include "surface_feet.hpp"

namespace meso::implicit {

/// A point of each of some sheets with the field's gradient there, and where to begin: between them. With bits of
/// `planes`, all of it stays in these planes of the box.
struct Sheets {
  Vec3 start;
  std::size_t count = 2;
  std::array<Vec3, 3> at{};
  std::array<Vec3, 3> gradient{};  ///< 0: not known
  unsigned planes = 0;
  double reach = 0;  ///< from the start
  Vec3 crease{};     ///< found: the nearest to the start at which all are zero
  bool found = false;
};

/// By their tangent planes, taken anew ever closer to where these meet; to within `accuracy`. Not found: sheets that
/// turn into one another, do not meet within reach, or where the field does not change its sign.
void find_creases(std::span<Sheets> sheets, double accuracy, SurfaceFeet& feet);

}  // namespace meso::implicit
