// SPDX-License-Identifier: Apache-2.0
#pragma once
// Three numbers, three by three, three by four: the only linear algebra that crosses room borders.
// Transforms read target_from_source and chain by eye: world_from_part * part_from_cell * p_cell.

#include <array>
#include <cmath>
#include <cstddef>

namespace meso {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  [[nodiscard]] double operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }
  [[nodiscard]] double& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

[[nodiscard]] inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
[[nodiscard]] inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
[[nodiscard]] inline Vec3 operator*(Vec3 a, double s) { return s * a; }
[[nodiscard]] inline Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
[[nodiscard]] inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

/// 3x3, row-major.
struct Mat3 {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return m[3 * row + column]; }
  [[nodiscard]] double& operator()(std::size_t row, std::size_t column) { return m[3 * row + column]; }
  [[nodiscard]] Vec3 column(std::size_t c) const { return {m[c], m[3 + c], m[6 + c]}; }
  [[nodiscard]] static Mat3 from_columns(Vec3 a, Vec3 b, Vec3 c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }
  friend bool operator==(const Mat3&, const Mat3&) = default;
};

[[nodiscard]] inline Vec3 operator*(const Mat3& a, Vec3 v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
          a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
}
[[nodiscard]] inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  return Mat3::from_columns(a * b.column(0), a * b.column(1), a * b.column(2));
}
[[nodiscard]] inline Mat3 transposed(const Mat3& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
[[nodiscard]] inline double determinant(const Mat3& a) { return dot(a.column(0), cross(a.column(1), a.column(2))); }

/// Right-handed rotation about the unit vector `axis` by `angle` radians (Rodrigues' formula).
[[nodiscard]] inline Mat3 rotation(Vec3 axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
  return {{t * axis.x * axis.x + c, t * axis.x * axis.y - s * axis.z, t * axis.x * axis.z + s * axis.y,
           t * axis.x * axis.y + s * axis.z, t * axis.y * axis.y + c, t * axis.y * axis.z - s * axis.x,
           t * axis.x * axis.z - s * axis.y, t * axis.y * axis.z + s * axis.x, t * axis.z * axis.z + c}};
}

/// Affine map p -> linear * p + translation; the 3x4 row-major matrix of the document.
struct Affine {
  Mat3 linear;
  Vec3 translation;

  [[nodiscard]] static Affine from_rows(const std::array<double, 12>& r) {
    return {{{r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10]}}, {r[3], r[7], r[11]}};
  }
  [[nodiscard]] static Affine from_translation(Vec3 t) { return {{}, t}; }
  friend bool operator==(const Affine&, const Affine&) = default;
};

[[nodiscard]] inline Vec3 operator*(const Affine& a, Vec3 p) { return a.linear * p + a.translation; }
[[nodiscard]] inline Affine operator*(const Affine& a, const Affine& b) {
  return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

/// Axis-aligned box; empty until extended.
struct Box3 {
  Vec3 min{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3 max{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  [[nodiscard]] bool empty() const { return !(min.x <= max.x); }
  void extend(Vec3 p) {
    for (std::size_t i = 0; i < 3; ++i) {
      min[i] = std::fmin(min[i], p[i]);
      max[i] = std::fmax(max[i], p[i]);
    }
  }
  [[nodiscard]] bool intersects(const Box3& b) const {
    return min.x <= b.max.x && b.min.x <= max.x && min.y <= b.max.y && b.min.y <= max.y && min.z <= b.max.z &&
           b.min.z <= max.z;
  }
  friend bool operator==(const Box3&, const Box3&) = default;
};

}  // namespace meso
