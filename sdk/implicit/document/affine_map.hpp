// SPDX-License-Identifier: Apache-2.0
#pragma once
// Inverses and stretch of affine maps. Private.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meso/base/vec.hpp"

namespace meso::implicit {

/// REQUIRES: a determinant that is not 0.
[[nodiscard]] inline Mat3 inverse(const Mat3& m) {
  const Vec3 a = m.column(0), b = m.column(1), c = m.column(2);
  const double scale = 1 / determinant(m);
  return transposed(Mat3::from_columns(scale * cross(b, c), scale * cross(c, a), scale * cross(a, b)));
}
[[nodiscard]] inline Affine inverse(const Affine& map) {
  const Mat3 back = inverse(map.linear);
  return {back, -(back * map.translation)};
}

/// The factor by which lengths shrink most: the smallest singular value, by the closed form of a symmetric matrix's
/// eigenvalues (Smith, 1961).
[[nodiscard]] inline double least_stretch(const Mat3& m) {
  const Mat3 s = transposed(m) * m;
  const double q = (s(0, 0) + s(1, 1) + s(2, 2)) / 3;
  const double off = s(0, 1) * s(0, 1) + s(0, 2) * s(0, 2) + s(1, 2) * s(1, 2);
  const double dx = s(0, 0) - q, dy = s(1, 1) - q, dz = s(2, 2) - q;
  const double p = std::sqrt((dx * dx + dy * dy + dz * dz + 2 * off) / 6);
  if (p <= 1e-14 * q) return std::sqrt(q);
  Mat3 b = s;
  for (std::size_t i = 0; i < 3; ++i) b(i, i) -= q;
  for (double& v : b.m) v /= p;
  const double angle = std::acos(std::clamp(determinant(b) / 2, -1.0, 1.0)) / 3;
  return std::sqrt(std::fmax(q + 2 * p * std::cos(angle + 2 * std::numbers::pi / 3), 0));
}

}  // namespace meso::implicit
