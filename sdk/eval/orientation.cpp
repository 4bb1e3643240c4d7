// SPDX-License-Identifier: Apache-2.0
#include "orientation.hpp"

#include <cmath>

namespace meso::eval {
namespace {

constexpr double parallel_tolerance = 1e-9;  // sine of the angle between two directions
constexpr double aligned_tolerance = 1e-12;

Vec3 unit(CellAxis axis) {
  Vec3 e;
  e[static_cast<std::size_t>(axis)] = 1;
  return e;
}
CellAxis next(CellAxis axis) { return static_cast<CellAxis>((static_cast<int>(axis) + 1) % 3); }

}  // namespace

Vec3 without_sign(Vec3 v) {
  for (std::size_t i = 3; i-- > 0;) {
    if (v[i] != 0) return v[i] > 0 ? v : -v;
  }
  return v;
}

bool is_parallel(Vec3 a, Vec3 b) {
  const double length = norm(b);
  return length == 0 || norm(cross(a / norm(a), b / length)) < parallel_tolerance;
}

Mat3 inverse(const Mat3& m) {
  const Vec3 a = m.column(0), b = m.column(1), c = m.column(2);
  const double d = determinant(m);
  return transposed(Mat3::from_columns(cross(b, c) / d, cross(c, a) / d, cross(a, b) / d));
}

Vec3 solve(const Mat3& m, Vec3 v) { return inverse(m) * v; }

Mat3 smallest_turn(CellAxis axis, Vec3 v) {
  const Vec3 e = unit(axis), target = v / norm(v);
  const Vec3 k = cross(e, target);
  const double sine = norm(k), cosine = dot(e, target);
  if (sine < aligned_tolerance) return cosine > 0 ? Mat3{} : rotation(unit(next(axis)), std::acos(-1.0));
  // Rodrigues' formula with sine and cosine at hand: exact to rounding also close to half a turn.
  const Vec3 n = k / sine;
  const double t = 1 - cosine;
  return {{t * n.x * n.x + cosine, t * n.x * n.y - k.z, t * n.x * n.z + k.y,  //
           t * n.x * n.y + k.z, t * n.y * n.y + cosine, t * n.y * n.z - k.x,  //
           t * n.x * n.z - k.y, t * n.y * n.z + k.x, t * n.z * n.z + cosine}};
}

Mat3 two_axis_turn(CellAxis first, Vec3 a, CellAxis second, Vec3 b) {
  const Vec3 u = a / norm(a);
  const Vec3 left = b - dot(b, u) * u;
  const Vec3 w = left / norm(left);
  Vec3 columns[3];
  columns[static_cast<std::size_t>(first)] = u;
  columns[static_cast<std::size_t>(second)] = w;
  const std::size_t third = 3 - static_cast<std::size_t>(first) - static_cast<std::size_t>(second);
  columns[third] = second == next(first) ? cross(u, w) : cross(w, u);
  return Mat3::from_columns(columns[0], columns[1], columns[2]);
}

}  // namespace meso::eval
