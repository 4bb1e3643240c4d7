// SPDX-License-Identifier: Apache-2.0
#pragma once
// Back through a matrix, by Cramer's rule. Private.

#include <cassert>
#include <optional>

#include "meso/base/vec.hpp"

namespace meso::membership {

/// x with m x = b; nothing if m is singular.
[[nodiscard]] inline std::optional<Vec3> solve(const Mat3& m, Vec3 b) {
  const Vec3 u = m.column(0), v = m.column(1), w = m.column(2);
  const double det = determinant(m);
  if (!(std::abs(det) > 1e-15 * norm(u) * norm(v) * norm(w))) return {};
  return Vec3{dot(b, cross(v, w)) / det, dot(u, cross(b, w)) / det, dot(u, cross(v, b)) / det};
}

/// `map` must have an inverse, as every placement and transform of a checked document has.
[[nodiscard]] inline Affine inverse(const Affine& map) {
  const auto x = solve(map.linear, {1, 0, 0}), y = solve(map.linear, {0, 1, 0}), z = solve(map.linear, {0, 0, 1});
  assert(x && y && z);
  const Mat3 back = Mat3::from_columns(*x, *y, *z);
  return {back, -(back * map.translation)};
}

}  // namespace meso::membership
