// SPDX-License-Identifier: Apache-2.0
#include "exact_sign.hpp"

#include <algorithm>
#include <limits>

namespace meso::implicit {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon() / 2;

int sign(double x) { return (x > 0) - (x < 0); }

/// A sum of doubles without rounding: components that do not overlap, smallest first (Shewchuk, Grow-Expansion).
class ExactSum {
 public:
  void add(double b) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = b + part_[i];
      const double of_part = sum - b;
      const double rest = (b - (sum - of_part)) + (part_[i] - of_part);
      if (rest != 0) part_[kept++] = rest;
      b = sum;
    }
    if (b != 0) part_[kept++] = b;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double high = a * b;
    add(std::fma(a, b, -high));
    add(high);
  }
  void add_product(double a, double b, double c) {
    const double high = a * b;
    add_product(std::fma(a, b, -high), c);
    add_product(high, c);
  }
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : implicit::sign(part_[size_ - 1]); }

 private:
  std::array<double, 100> part_;  // 24 products of three numbers, four components each
  std::size_t size_ = 0;
};

void add_determinant(ExactSum& sum, Vec3 a, Vec3 b, Vec3 c) {
  sum.add_product(a.x, b.y, c.z);
  sum.add_product(-a.x, b.z, c.y);
  sum.add_product(a.y, b.z, c.x);
  sum.add_product(-a.y, b.x, c.z);
  sum.add_product(a.z, b.x, c.y);
  sum.add_product(-a.z, b.y, c.x);
}

/// Is b - a a double? (Shewchuk, Two-Diff-Tail: the rounding error.)
bool is_exact(double a, double b) {
  const double d = b - a;
  const double of_a = b - d;
  return (b - (d + of_a)) + (of_a - a) == 0;
}
bool is_exact(Vec3 a, Vec3 b) { return is_exact(a.x, b.x) && is_exact(a.y, b.y) && is_exact(a.z, b.z); }

int exact_turn(Point2 a, Point2 b, Point2 p) {
  ExactSum sum;
  sum.add_product(b.u, p.v);
  sum.add_product(-b.u, a.v);
  sum.add_product(-a.u, p.v);
  sum.add_product(-b.v, p.u);
  sum.add_product(b.v, a.u);
  sum.add_product(a.v, p.u);
  return sum.sign();
}

int exact_side(const Triangle& t, Vec3 p) {
  ExactSum sum;
  if (is_exact(p, t[0]) && is_exact(p, t[1]) && is_exact(p, t[2])) {
    // The volume of the tetrahedron seen from p has the opposite sign.
    add_determinant(sum, t[0] - p, t[1] - p, t[2] - p);
    return -sum.sign();
  }
  add_determinant(sum, t[1], t[2], p);
  add_determinant(sum, -t[0], t[2], p);
  add_determinant(sum, t[0], t[1], p);
  add_determinant(sum, -t[0], t[1], t[2]);
  return sum.sign();
}

bool within(double p, double a, double b, double c) { return std::min({a, b, c}) <= p && p <= std::max({a, b, c}); }

/// Closed, also where the triangle is seen edge-on.
bool is_on_flat(Point2 a, Point2 b, Point2 c, Point2 p) {
  if (!within(p.u, a.u, b.u, c.u) || !within(p.v, a.v, b.v, c.v)) return false;
  const int s = turn_sign(a, b, p), t = turn_sign(b, c, p), r = turn_sign(c, a, p);
  return (s >= 0 && t >= 0 && r >= 0) || (s <= 0 && t <= 0 && r <= 0);
}

}  // namespace

int turn_sign(Point2 a, Point2 b, Point2 p) {
  const double left = (b.u - a.u) * (p.v - a.v), right = (b.v - a.v) * (p.u - a.u);
  const double area = left - right;
  // Shewchuk, orient2d: (3 + 16 eps) eps
  const double bound = (3 + 16 * eps) * eps * (std::abs(left) + std::abs(right));
  if (std::abs(area) > bound || bound == 0) return sign(area);
  return exact_turn(a, b, p);
}

int side_sign(const Triangle& t, Vec3 p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double bc1 = b.x * c.y, bc2 = b.y * c.x, ca1 = c.x * a.y, ca2 = c.y * a.x, ab1 = a.x * b.y, ab2 = a.y * b.x;
  const double volume = a.z * (bc1 - bc2) + b.z * (ca1 - ca2) + c.z * (ab1 - ab2);
  const double size = std::abs(a.z) * (std::abs(bc1) + std::abs(bc2)) +
                      std::abs(b.z) * (std::abs(ca1) + std::abs(ca2)) + std::abs(c.z) * (std::abs(ab1) + std::abs(ab2));
  // Shewchuk, orient3d: (7 + 56 eps) eps
  const double bound = (7 + 56 * eps) * eps * size;
  if (std::abs(volume) > bound || bound == 0) return -sign(volume);
  return exact_side(t, p);
}

bool is_on(const Triangle& t, Vec3 p) {
  // A triangle with area is seen with area from at least one axis; one without is a segment, seen as one from all.
  return is_on_flat({t[0].y, t[0].z}, {t[1].y, t[1].z}, {t[2].y, t[2].z}, {p.y, p.z}) &&
         is_on_flat({t[0].z, t[0].x}, {t[1].z, t[1].x}, {t[2].z, t[2].x}, {p.z, p.x}) &&
         is_on_flat({t[0].x, t[0].y}, {t[1].x, t[1].y}, {t[2].x, t[2].y}, {p.x, p.y}) && side_sign(t, p) == 0;
}

RayView view_along_x(const Triangle& t, double y, double z) {
  std::array<int, 3> raw, moved;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = t[i], &b = t[(i + 1) % 3];
    raw[i] = moved[i] = turn_sign({a.y, a.z}, {b.y, b.z}, {y, z});
    // turn(a, b, p + (e, e^2)) = turn(a, b, p) - (b.z - a.z) e + (b.y - a.y) e^2
    if (raw[i] == 0) moved[i] = b.z != a.z ? sign(a.z - b.z) : sign(b.y - a.y);
  }
  RayView view;
  if (moved[0] == moved[1] && moved[1] == moved[2]) view.crossing = moved[0];
  const auto [low, high] = std::minmax({raw[0], raw[1], raw[2]});
  view.touches = raw[0] * raw[1] * raw[2] == 0 && low * high >= 0;
  return view;
}

}  // namespace meso::implicit
