// SPDX-License-Identifier: Apache-2.0
// Formulas and extents of the leaves.

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "node.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

Term squared(const Term& t) { return t * t; }
Term positive(const Term& t) { return max(t, Term::constant(0)); }
Term select(const Term& condition, const Term& first, const Term& second) {
  return Term::apply(Op::select, {condition, first, second});
}
Term linear(Vec3 factors, const std::array<Term, 3>& p, double constant) {
  Term sum = Term::constant(constant);
  for (std::size_t axis = 3; axis-- > 0;) {
    if (factors[axis] == 0) continue;
    const Term product = factors[axis] == 1 ? p[axis] : factors[axis] * p[axis];
    sum = sum.is_constant() && sum.node().number == 0 ? product : product + sum;
  }
  return sum;
}

using Coordinates = std::array<Term, 3>;

Term formula(const Ball& s, const Coordinates& p) {
  return sqrt(squared(p[0]) + squared(p[1]) + squared(p[2])) - s.radius;
}

Term formula(const Cuboid& s, const Coordinates& p) {
  const Coordinates q{abs(p[0]) - s.half_size.x, abs(p[1]) - s.half_size.y, abs(p[2]) - s.half_size.z};
  const Term outside = sqrt(squared(positive(q[0])) + squared(positive(q[1])) + squared(positive(q[2])));
  const Term inside = min(max(max(q[0], q[1]), q[2]), Term::constant(0));
  return outside + inside;
}

Term formula(const Cylinder& s, const Coordinates& p) { return sqrt(squared(p[0]) + squared(p[1])) - s.radius; }

// The profile in the half-plane (rho, z) is a convex trapezoid: inside, the nearest of its sides' lines is the nearest
// side; outside, the distance is that to its nearest side as a segment.
Term formula(const Cone& s, const Coordinates& p) {
  const Term rho = sqrt(squared(p[0]) + squared(p[1]));
  const Term& z = p[2];
  const double run = s.top_radius - s.bottom_radius, length2 = run * run + s.height * s.height;
  const double length = std::sqrt(length2);
  const Term from_bottom = rho - s.bottom_radius;
  const Term slant = s.height / length * from_bottom - (run / length) * z;
  const Term inside = max(max(-z, z - s.height), slant);

  const Term bottom = squared(positive(from_bottom)) + squared(z);
  const Term top = squared(positive(rho - s.top_radius)) + squared(z - s.height);
  const Term along = Term::apply(
      Op::clamp, {(run / length2) * from_bottom + (s.height / length2) * z, Term::constant(0), Term::constant(1)});
  const Term side = squared(from_bottom - run * along) + squared(z - s.height * along);
  const Term outside = sqrt(min(min(bottom, top), side));
  return select(Term::apply(Op::greater, {inside, Term::constant(0)}), outside, inside);
}

Term formula(const Torus& s, const Coordinates& p) {
  const Term ring = sqrt(squared(p[0]) + squared(p[1])) - s.major_radius;
  return sqrt(squared(ring) + squared(p[2])) - s.minor_radius;
}

Term formula(const Capsule& s, const Coordinates& p) {
  const Vec3 axis = s.to - s.from;
  const double length2 = dot(axis, axis);
  Coordinates d{p[0] - s.from.x, p[1] - s.from.y, p[2] - s.from.z};
  if (length2 > 0) {
    const Term along = Term::apply(Op::clamp, {linear(axis / length2, d, 0), Term::constant(0), Term::constant(1)});
    for (std::size_t i = 0; i < 3; ++i)
      if (axis[i] != 0) d[i] = d[i] - axis[i] * along;
  }
  return sqrt(squared(d[0]) + squared(d[1]) + squared(d[2])) - s.radius;
}

Term formula(const HalfSpace& s, const Coordinates& p) { return linear(s.unit_normal, p, -s.offset); }

/// Centre and half extent along one axis of the world: what a leaf of axes of its own looks like from there.
struct Extent {
  double lo, hi;
};

/// Bounds of a sum of rotated parts are exact unless several of their addends are rounded.
Extent around(double centre, double half, Vec3 row) {
  const bool straight = (row.x != 0) + (row.y != 0) + (row.z != 0) <= 1;
  const double pad = straight || std::isinf(half) ? 0 : 1e-15 * (std::abs(centre) + half);
  return {centre - half - pad, centre + half + pad};
}
Extent joined(Extent a, Extent b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

// extent(): of {f <= level} along the axis whose row of world_from_local is `row` and `centre`; nothing if it is empty.
using MaybeExtent = std::optional<Extent>;

MaybeExtent extent(const Ball& s, double level, Vec3 row, double centre) {
  if (s.radius + level < 0) return {};
  return around(centre, (s.radius + level) * norm(row), row);
}

MaybeExtent extent(const Cuboid& s, double level, Vec3 row, double centre) {
  const double outer = std::max(level, 0.0), inner = std::min(level, 0.0);
  const Vec3 h = s.half_size + Vec3{inner, inner, inner};
  if (h.x < 0 || h.y < 0 || h.z < 0) return {};
  const double half = std::abs(row.x) * h.x + std::abs(row.y) * h.y + std::abs(row.z) * h.z;
  return around(centre, half + outer * norm(row), row);
}

MaybeExtent extent(const Cylinder& s, double level, Vec3 row, double centre) {
  if (s.radius + level < 0) return {};
  // An axis that is tilted by rounding noise is not tilted.
  if (std::abs(row.z) > 1e-14 * norm(row)) return Extent{-infinity, infinity};
  return around(centre, (s.radius + level) * std::hypot(row.x, row.y), row);
}

MaybeExtent extent(const Cone& s, double level, Vec3 row, double centre) {
  const double radial = std::hypot(row.x, row.y), grown = std::max(level, 0.0) * norm(row);
  return joined(around(centre, s.bottom_radius * radial + grown, row),
                around(centre + row.z * s.height, s.top_radius * radial + grown, row));
}

MaybeExtent extent(const Torus& s, double level, Vec3 row, double centre) {
  const double radius = s.minor_radius + level;
  if (radius < 0) return {};
  return around(centre, s.major_radius * std::hypot(row.x, row.y) + radius * norm(row), row);
}

MaybeExtent extent(const Capsule& s, double level, Vec3 row, double centre) {
  const double radius = s.radius + level;
  if (radius < 0) return {};
  return joined(around(centre + dot(row, s.from), radius * norm(row), row),
                around(centre + dot(row, s.to), radius * norm(row), row));
}

/// The half-space sign * (n . p - d) <= level ends along an axis only if that is its normal.
Box3 half_space_bounds(const HalfSpace& s, double sign, double level, const Affine& local_from_world) {
  const Vec3 slope = sign * (transposed(local_from_world.linear) * s.unit_normal);
  const double constant = sign * (dot(s.unit_normal, local_from_world.translation) - s.offset);
  Box3 box = everywhere;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(slope[axis]) < (1 - 1e-14) * norm(slope)) continue;
    const double end = (level - constant) / slope[axis];
    (slope[axis] > 0 ? box.max : box.min)[axis] = end;
  }
  return box;
}

/// The image of a box, infinite ends and all.
Box3 image(const Box3& box, const Affine& map) {
  if (box.empty()) return {};
  Box3 result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 row{map.linear(axis, 0), map.linear(axis, 1), map.linear(axis, 2)};
    Extent sum{map.translation[axis], map.translation[axis]};
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(row[k]) <= 1e-14 * norm(row)) continue;
      const double a = row[k] * box.min[k], b = row[k] * box.max[k];
      sum.lo += std::min(a, b);
      sum.hi += std::max(a, b);
    }
    const bool straight = (row.x != 0) + (row.y != 0) + (row.z != 0) <= 1;
    const auto pad = [&](double v) { return straight || std::isinf(v) ? 0 : 1e-14 * std::abs(v); };
    result.min[axis] = sum.lo - pad(sum.lo);
    result.max[axis] = sum.hi + pad(sum.hi);
  }
  return result;
}

}  // namespace

Term lowered_leaf(const Field::Node& leaf, const Affine& local_from_world) {
  return std::visit(
      [&](const auto& shape) -> Term {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, LevelSet>) {
          return shape.term.at(local_from_world);
        } else if constexpr (std::is_same_v<Shape, External>) {
          return Term::external(shape.field, local_from_world);
        } else if constexpr (requires(Coordinates p) { formula(shape, p); }) {
          Coordinates p;
          for (std::size_t row = 0; row < 3; ++row) p[row] = Term::coordinate(row).at(local_from_world);
          return formula(shape, p);
        } else {
          assert(!"a leaf");
          return {};
        }
      },
      leaf.kind);
}

Box3 leaf_bounds(const Field::Node& leaf, double sign, double level, const Affine& world_from_local,
                 const Affine& local_from_world) {
  return std::visit(
      [&](const auto& shape) -> Box3 {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, LevelSet>) {
          const double least = sign > 0 ? shape.range.lo : -shape.range.hi;
          return level < least ? Box3{} : everywhere;
        } else if constexpr (std::is_same_v<Shape, External>) {
          return sign > 0 ? image(shape.field->bounds(level), world_from_local) : everywhere;
        } else if constexpr (std::is_same_v<Shape, HalfSpace>) {
          return half_space_bounds(shape, sign, level, local_from_world);
        } else if constexpr (requires { extent(shape, level, Vec3{}, 0.0); }) {
          if (sign < 0) return everywhere;  // the outside of what is bounded
          Box3 box;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const Mat3& m = world_from_local.linear;
            const MaybeExtent e =
                extent(shape, level, {m(axis, 0), m(axis, 1), m(axis, 2)}, world_from_local.translation[axis]);
            if (!e) return {};
            box.min[axis] = e->lo;
            box.max[axis] = e->hi;
          }
          return box;
        } else {
          assert(!"a leaf");
          return everywhere;
        }
      },
      leaf.kind);
}

}  // namespace meso::implicit
