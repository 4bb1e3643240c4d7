// SPDX-License-Identifier: Apache-2.0
#pragma once
// The tree behind a Field.

#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "meso/implicit/field.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {

inline constexpr double infinity = HUGE_VAL;
inline const Box3 everywhere{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};

// Leaves, in coordinates of their own.
struct Ball {
  double radius;
};
struct Cuboid {
  Vec3 half_size;
};
struct Cylinder {
  double radius;
};
struct Cone {
  double bottom_radius, top_radius, height;
};
struct Torus {
  double major_radius, minor_radius;
};
struct Capsule {
  Vec3 from, to;
  double radius;
};
struct HalfSpace {
  Vec3 unit_normal;
  double offset;
};
struct LevelSet {
  Term term;
  Interval range;  ///< of all its values
};
struct External {
  std::shared_ptr<const ExternalField> field;
};

// Operations on one field.
/// value_factor * f(inverse p)
struct Move {
  Affine map, inverse;
  double value_factor;
};
struct Offset {
  double distance;
};
struct Shell {
  double half_thickness;
};
struct Complement {};

// Operations on two.
struct Union {};
struct Intersection {};
struct FilletedUnion {
  double radius;
};

struct Field::Node {
  std::variant<Ball, Cuboid, Cylinder, Cone, Torus, Capsule, HalfSpace, LevelSet, External, Move, Offset, Shell,
               Complement, Union, Intersection, FilletedUnion>
      kind;
  double lipschitz = 1;
  std::shared_ptr<const Node> a{}, b{};

  /// Prepared at the first question.
  mutable std::once_flag prepared{};
  mutable std::unique_ptr<const FlatTerm> flat{};

  ~Node();
};

/// What a leaf means at `local_from_world` p.
[[nodiscard]] Term lowered_leaf(const Field::Node& leaf, const Affine& local_from_world);
/// Holds the leaf's {sign * f <= level}, sign 1 or -1, in the world. The two maps are inverse to each other.
[[nodiscard]] Box3 leaf_bounds(const Field::Node& leaf, double sign, double level, const Affine& world_from_local,
                               const Affine& local_from_world);

[[nodiscard]] Term lowered(const Field::Node& node);
/// Holds {sign * f <= level}.
[[nodiscard]] Box3 bounds_of(const Field::Node& node, double sign, double level);

}  // namespace meso::implicit
