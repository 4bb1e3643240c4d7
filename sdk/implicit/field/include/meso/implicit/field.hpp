// SPDX-License-Identifier: Apache-2.0
#pragma once
// A body as a function of the point: negative inside, positive outside, zero on the surface. Fields are values: build
// them from primitives, surfaces and expressions, compose them, ask them, and lower them to a Term to be contoured.
//
//   DiagnosticSink sink;
//   const Field gyroid = *Field::surface("gyroid", sink);
//   const Field part = intersection_of(Field::ball(4), gyroid.scaled(4).shell(0.7));
//   part.value({0.3, 0.2, 0.1});         // < 0: inside
//   part.bounds();                       // (-4, -4, -4) ... (4, 4, 4)
//
// Millimetres and radians. Primitives are exact distances; rigid moves and uniform scaling keep that, offsets and
// booleans keep a lower bound. Surfaces and expressions are level sets: their offsets and shells are shifts of level,
// not lengths. Every operation costs the same however deep the field is, and chains of any length are fine. Const
// members may be called by many threads; copies share everything.
//
// The functions here assert their REQUIRES; field_arguments.hpp checks the same conditions for arguments of a user.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/vec.hpp"
#include "meso/implicit/external_field.hpp"
#include "meso/implicit/interval.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

/// A name with a value in an expression.
struct Parameter {
  std::string name;
  double value = 0;
};

class Field {
 public:
  // Primitives: exact distances. Sizes are positive and finite.
  [[nodiscard]] static Field ball(double radius = 1);
  [[nodiscard]] static Field box(Vec3 half_size = {1, 1, 1});
  [[nodiscard]] static Field cylinder(double radius = 1);  ///< about the z axis, without ends
  /// About the z axis, from z = 0 to z = height; one radius may be 0, equal ones give a cylinder with ends.
  [[nodiscard]] static Field cone(double bottom_radius = 1, double top_radius = 0, double height = 1);
  /// About the z axis. REQUIRES: 0 < minor_radius <= major_radius.
  [[nodiscard]] static Field torus(double major_radius = 1, double minor_radius = 0.25);
  /// All points within `radius` of the segment.
  [[nodiscard]] static Field capsule(Vec3 from, Vec3 to, double radius);
  /// dot(p, normal / |normal|) <= offset. REQUIRES: normal is not 0.
  [[nodiscard]] static Field half_space(Vec3 normal, double offset = 0);

  // Level sets.
  /// A periodic surface of unit period by its name or an alias (surfaces.hpp), with or without "tpms." before it.
  /// Unknown: IMPLICIT_UNKNOWN_SURFACE, and nothing.
  [[nodiscard]] static std::optional<Field> surface(std::string_view name, DiagnosticSink& sink);
  /// A text in the language of docs/specification/expressions.md over x, y, z and the parameters. A fault is reported
  /// with SourceSpan::offset and length counted in bytes of the text.
  [[nodiscard]] static std::optional<Field> expression(std::string_view text, DiagnosticSink& sink,
                                                       std::span<const Parameter> parameters = {});
  [[nodiscard]] static Field from_term(const Term& term);
  [[nodiscard]] static Field external(std::shared_ptr<const ExternalField> field);

  // Moves. The body moves: this->translated(d).value(p + d) == this->value(p).
  [[nodiscard]] Field translated(Vec3 displacement) const;
  [[nodiscard]] Field scaled(double factor) const;  ///< negative: also inverted. REQUIRES: not 0
  /// Along the axes; values shrink so that they stay lower bounds. REQUIRES: no factor is 0.
  [[nodiscard]] Field scaled(Vec3 factors) const;
  [[nodiscard]] Field rotated(Vec3 axis, double angle) const;  ///< right-handed. REQUIRES: axis is not 0
  /// Turned, the shortest way, so that its z axis points along `direction`; straight down is half a turn about x.
  [[nodiscard]] Field oriented(Vec3 direction) const;
  [[nodiscard]] Field mirrored(Vec3 normal) const;  ///< across the plane through the origin
  /// By any affine map; values are multiplied by `value_factor`, which the map's least stretch makes a lower bound.
  /// REQUIRES: a map whose inverse is `inverse`; a positive factor.
  [[nodiscard]] Field mapped(const Affine& map, const Affine& inverse, double value_factor) const;

  // Levels.
  [[nodiscard]] Field offset(double distance) const;  ///< f - distance: grows by it
  [[nodiscard]] Field shell(double thickness) const;  ///< |f| - thickness / 2. REQUIRES: thickness >= 0
  [[nodiscard]] Field complement() const;             ///< -f
  /// The four bodies that a level set has. Shells as lower <= f <= upper are eccentric.
  [[nodiscard]] Field endoskeleton(double isovalue = 0) const { return offset(isovalue); }
  [[nodiscard]] Field exoskeleton(double isovalue = 0) const { return offset(isovalue).complement(); }
  /// REQUIRES: lower <= upper.
  [[nodiscard]] Field eccentric_shell(double lower, double upper) const;

  // Booleans.
  friend Field union_of(const Field& a, const Field& b);         ///< min(a, b)
  friend Field intersection_of(const Field& a, const Field& b);  ///< max(a, b)
  friend Field difference_of(const Field& a, const Field& b);    ///< max(a, -b)
  /// With a fillet where the two surfaces meet: round of this radius if they are planes at right angles and distances.
  /// max(r, min(a, b)) - |(max(r - a, 0), max(r - b, 0))|; 0 is the union without. REQUIRES: radius >= 0.
  friend Field union_of(const Field& a, const Field& b, double radius);

  // Questions. The first one to a field prepares it, in time linear in its size.
  [[nodiscard]] double value(Vec3 p) const;
  /// REQUIRES: as many values as points. Several times faster per point than value().
  void values(std::span<const Vec3> points, std::span<double> out) const;
  [[nodiscard]] Vec3 gradient(Vec3 p) const;  ///< one-sided where the field has a kink
  [[nodiscard]] Interval interval(const Box3& box) const;
  /// |f(p) - f(q)| <= lipschitz() |p - q| for all p, q; infinity if no bound is known.
  [[nodiscard]] double lipschitz() const;
  /// Holds {f <= level}; infinite where the body is or where nothing better is known; empty if it certainly is.
  [[nodiscard]] Box3 bounds(double level = 0) const;
  /// Holds {-f <= level}: where the complement's body is.
  [[nodiscard]] Box3 complement_bounds(double level = 0) const;
  /// What compile() takes. Deterministic: the same calls give the same tree.
  [[nodiscard]] Term term() const;

  struct Node;  ///< of the tree; private to the room

 private:
  explicit Field(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
};

[[nodiscard]] Field union_of(const Field& a, const Field& b);
[[nodiscard]] Field intersection_of(const Field& a, const Field& b);
[[nodiscard]] Field difference_of(const Field& a, const Field& b);
[[nodiscard]] Field union_of(const Field& a, const Field& b, double radius);
/// The same of complements: edges of what is left are rounded.
[[nodiscard]] Field intersection_of(const Field& a, const Field& b, double radius);
[[nodiscard]] Field difference_of(const Field& a, const Field& b, double radius);

}  // namespace meso::implicit
