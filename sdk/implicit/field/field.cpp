// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/field.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "meso/expr/expression.hpp"
#include "meso/expr/nearest.hpp"
#include "meso/implicit/field_arguments.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/surfaces.hpp"
#include "node.hpp"

namespace meso::implicit {

namespace {

using NodePointer = std::shared_ptr<const Field::Node>;

template <class Kind>
NodePointer leaf(Kind kind, double lipschitz = 1) {
  const auto node = std::make_shared<Field::Node>();
  node->kind = std::move(kind);
  node->lipschitz = lipschitz;
  return node;
}

template <class Kind>
NodePointer operation(Kind kind, NodePointer a, NodePointer b = nullptr) {
  const auto node = std::make_shared<Field::Node>();
  node->kind = kind;
  node->lipschitz = b ? std::max(a->lipschitz, b->lipschitz) : a->lipschitz;
  node->a = std::move(a);
  node->b = std::move(b);
  return node;
}

/// Divided by its largest component first, so that neither tiny nor huge vectors lose their direction.
Vec3 unit(Vec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const Vec3 scaled = v / largest;
  return scaled / norm(scaled);
}

/// Turns by a quarter are exact: the cosine of the double nearest to pi / 2 is 6e-17, which would tilt a cylinder.
Mat3 exact_rotation(Vec3 axis, double angle) {
  double c = std::cos(angle), s = std::sin(angle);
  if (std::abs(c) < 1e-15) {
    c = 0;
    s = std::copysign(1, s);
  } else if (std::abs(s) < 1e-15) {
    s = 0;
    c = std::copysign(1, c);
  }
  const double t = 1 - c;
  return {{t * axis.x * axis.x + c, t * axis.x * axis.y - s * axis.z, t * axis.x * axis.z + s * axis.y,
           t * axis.x * axis.y + s * axis.z, t * axis.y * axis.y + c, t * axis.y * axis.z - s * axis.x,
           t * axis.x * axis.z - s * axis.y, t * axis.y * axis.z + s * axis.x, t * axis.z * axis.z + c}};
}

/// The shortest turn that takes the z axis to the unit vector d: I + [v] + [v]^2 / (1 + d.z) with v = z x d.
Mat3 turn_of_z_axis(Vec3 d) {
  const double side2 = d.x * d.x + d.y * d.y;
  if (side2 == 0) return d.z > 0 ? Mat3{} : Mat3{{1, 0, 0, 0, -1, 0, 0, 0, -1}};
  const double k = d.z > 0 ? 1 / (1 + d.z) : (1 - d.z) / side2;
  return {{1 - k * d.x * d.x, -k * d.x * d.y, d.x, -k * d.x * d.y, 1 - k * d.y * d.y, d.y, -d.x, -d.y, d.z}};
}

NodePointer moved(const NodePointer& a, const Mat3& linear, const Mat3& inverse, double value_factor) {
  return operation(Move{{linear, {}}, {inverse, {}}, value_factor}, a);
}

const FlatTerm& prepared(const Field::Node& node) {
  std::call_once(node.prepared, [&] { node.flat = std::make_unique<const FlatTerm>(lowered(node)); });
  return *node.flat;
}

std::string suggestion(std::string_view meant) {
  return meant.empty() ? "" : "; did you mean '" + std::string(meant) + "'?";
}

NodePointer level_set(const Term& term) {
  const FlatTerm flat(term);
  return leaf(LevelSet{term, flat.interval(everywhere)}, flat.lipschitz(everywhere));
}

/// The term of a surface's text.
Term surface_term(const Surface& surface) {
  const expr::ParseResult parsed = expr::parse_expression(surface.expression, LengthUnit::millimeter);
  assert(parsed.expression && "the table's texts are checked by a test");
  std::vector<Term> axes;
  for (const expr::Name& name : parsed.expression->names())
    axes.push_back(Term::coordinate(static_cast<std::size_t>(name.text[0] - 'x')));
  return Term::from_expression(*parsed.expression, axes);
}

}  // namespace

// A chain of a hundred thousand operations must not be destroyed by as many nested calls.
Field::Node::~Node() {
  std::vector<std::shared_ptr<const Node>> doomed;
  const auto doom = [&](const Node& node) {
    auto& orphan = const_cast<Node&>(node);  // about to be destroyed, and made as Node by make_shared
    if (orphan.a) doomed.push_back(std::move(orphan.a));
    if (orphan.b) doomed.push_back(std::move(orphan.b));
  };
  doom(*this);
  while (!doomed.empty()) {
    const std::shared_ptr<const Node> node = std::move(doomed.back());
    doomed.pop_back();
    if (node.use_count() == 1) doom(*node);
  }
}

Field Field::ball(double radius) {
  assert(!check_size("", radius));
  return Field(leaf(Ball{radius}));
}
Field Field::box(Vec3 half_size) {
  assert(!check_size("", half_size.x) && !check_size("", half_size.y) && !check_size("", half_size.z));
  return Field(leaf(Cuboid{half_size}));
}
Field Field::cylinder(double radius) {
  assert(!check_size("", radius));
  return Field(leaf(Cylinder{radius}));
}
Field Field::cone(double bottom_radius, double top_radius, double height) {
  assert(!check_cone(bottom_radius, top_radius, height));
  return Field(leaf(Cone{bottom_radius, top_radius, height}));
}
Field Field::torus(double major_radius, double minor_radius) {
  assert(!check_torus(major_radius, minor_radius));
  return Field(leaf(Torus{major_radius, minor_radius}));
}
Field Field::capsule(Vec3 from, Vec3 to, double radius) {
  assert(!check_translation(from) && !check_translation(to) && !check_size("", radius));
  return Field(leaf(Capsule{from, to, radius}));
}
Field Field::half_space(Vec3 normal, double offset) {
  assert(!check_direction("", normal) && !check_number("", offset));
  return Field(leaf(HalfSpace{unit(normal), offset}));
}

std::optional<Field> Field::surface(std::string_view name, DiagnosticSink& sink) {
  const Surface* surface = find_surface(name);
  if (surface == nullptr) {
    sink.report(
        {.code = Code::implicit_unknown_surface, .args = {std::string(name), suggestion(nearest_surface(name))}});
    return std::nullopt;
  }
  return Field(leaf(LevelSet{surface_term(*surface), {surface->min, surface->max, false}}, surface->lipschitz));
}

namespace {

// Where a text has no value the point is outside of it, whatever the field is combined with: min gives its first
// operand where the second is not a number. Texts that have a value everywhere stay as they are.
Term outside_where_undefined(const Term& term) {
  constexpr double far = 1e9, undefined_value = 1e30;
  if (!interval_of(term, {{-far, -far, -far}, {far, far, far}}).undefined) return term;
  return min(Term::constant(undefined_value), term);
}

}  // namespace

std::optional<Field> Field::expression(std::string_view text, DiagnosticSink& sink,
                                       std::span<const Parameter> parameters) {
  const expr::ParseResult parsed = expr::parse_expression(text, LengthUnit::millimeter);
  if (!parsed.expression) {
    const expr::ParseError& error = *parsed.error;
    sink.report({.code = error.code, .where = {.offset = error.offset, .length = error.length}, .args = error.args});
    return std::nullopt;
  }
  std::vector<std::string_view> known{"x", "y", "z"};
  std::vector<Term> meanings{Term::coordinate(0), Term::coordinate(1), Term::coordinate(2)};
  for (const Parameter& parameter : parameters) {
    known.push_back(parameter.name);
    meanings.push_back(Term::constant(parameter.value));
  }
  std::vector<Term> term_of_name;
  for (const expr::Name& name : parsed.expression->names()) {
    const auto found = std::find(known.begin(), known.end(), name.text);
    if (found == known.end()) {
      sink.report({.code = Code::expression_unknown_name,
                   .where = {.offset = name.offset, .length = name.text.size()},
                   .args = {name.text, suggestion(expr::nearest(name.text, known))}});
      return std::nullopt;
    }
    term_of_name.push_back(meanings[static_cast<std::size_t>(found - known.begin())]);
  }
  return from_term(outside_where_undefined(Term::from_expression(*parsed.expression, term_of_name)));
}

Field Field::from_term(const Term& term) { return Field(level_set(term)); }

Field Field::external(std::shared_ptr<const ExternalField> field) {
  const double lipschitz = field->lipschitz();
  return Field(leaf(External{std::move(field)}, lipschitz));
}

Field Field::translated(Vec3 displacement) const {
  assert(!check_translation(displacement));
  return Field(
      operation(Move{Affine::from_translation(displacement), Affine::from_translation(-displacement), 1}, node_));
}

Field Field::scaled(double factor) const { return scaled(Vec3{factor, factor, factor}); }

Field Field::scaled(Vec3 factors) const {
  assert(!check_scale(factors));
  const Mat3 map{{factors.x, 0, 0, 0, factors.y, 0, 0, 0, factors.z}};
  const Mat3 inverse{{1 / factors.x, 0, 0, 0, 1 / factors.y, 0, 0, 0, 1 / factors.z}};
  const double least = std::min({std::abs(factors.x), std::abs(factors.y), std::abs(factors.z)});
  return Field(moved(node_, map, inverse, least));
}

Field Field::rotated(Vec3 axis, double angle) const {
  assert(!check_rotation(axis, angle));
  const Mat3 turn = exact_rotation(unit(axis), angle);
  return Field(moved(node_, turn, transposed(turn), 1));
}

Field Field::oriented(Vec3 direction) const {
  assert(!check_direction("", direction));
  const Mat3 turn = turn_of_z_axis(unit(direction));
  return Field(moved(node_, turn, transposed(turn), 1));
}

Field Field::mirrored(Vec3 normal) const {
  assert(!check_direction("", normal));
  const Vec3 n = unit(normal);
  const Mat3 flip =
      Mat3::from_columns(Vec3{1, 0, 0} - 2 * n.x * n, Vec3{0, 1, 0} - 2 * n.y * n, Vec3{0, 0, 1} - 2 * n.z * n);
  return Field(moved(node_, flip, flip, 1));
}

Field Field::mapped(const Affine& map, const Affine& inverse, double value_factor) const {
  assert(value_factor > 0);
  return Field(operation(Move{map, inverse, value_factor}, node_));
}

Field Field::offset(double distance) const {
  assert(!check_number("", distance));
  return Field(operation(Offset{distance}, node_));
}
Field Field::shell(double thickness) const {
  assert(!check_shell(thickness));
  return Field(operation(Shell{thickness / 2}, node_));
}
Field Field::complement() const { return Field(operation(Complement{}, node_)); }

Field Field::eccentric_shell(double lower, double upper) const {
  assert(!check_eccentric_shell(lower, upper));
  return offset(0.5 * (lower + upper)).shell(upper - lower);
}

Field union_of(const Field& a, const Field& b) { return Field(operation(Union{}, a.node_, b.node_)); }
Field intersection_of(const Field& a, const Field& b) { return Field(operation(Intersection{}, a.node_, b.node_)); }
Field difference_of(const Field& a, const Field& b) { return intersection_of(a, b.complement()); }

Field union_of(const Field& a, const Field& b, double radius) {
  assert(radius >= 0);
  if (radius == 0) return union_of(a, b);
  const auto node = std::make_shared<Field::Node>();
  node->kind = FilletedUnion{radius};
  // Both may fall at once.
  node->lipschitz = std::hypot(a.node_->lipschitz, b.node_->lipschitz);
  node->a = a.node_;
  node->b = b.node_;
  return Field(node);
}
Field intersection_of(const Field& a, const Field& b, double radius) {
  return radius == 0 ? intersection_of(a, b) : union_of(a.complement(), b.complement(), radius).complement();
}
Field difference_of(const Field& a, const Field& b, double radius) {
  return radius == 0 ? difference_of(a, b) : union_of(a.complement(), b, radius).complement();
}

double Field::value(Vec3 p) const { return prepared(*node_).value(p); }
void Field::values(std::span<const Vec3> points, std::span<double> out) const { prepared(*node_).values(points, out); }
Vec3 Field::gradient(Vec3 p) const { return prepared(*node_).gradient(p); }
double Field::lipschitz() const { return node_->lipschitz; }
Box3 Field::bounds(double level) const { return bounds_of(*node_, 1, level); }
Box3 Field::complement_bounds(double level) const { return bounds_of(*node_, -1, level); }
Term Field::term() const { return lowered(*node_); }

Interval Field::interval(const Box3& box) const {
  const FlatTerm& flat = prepared(*node_);
  Interval range = flat.interval(box);
  // From the middle no value is further than the slope allows; in small boxes that is often the narrower bound.
  const Vec3 centre = 0.5 * (box.min + box.max);
  const double reach = lipschitz() * 0.5 * norm(box.max - box.min) * (1 + 1e-14);
  const double middle = flat.value(centre);
  if (!std::isfinite(reach) || !std::isfinite(middle)) return range;
  const double slack = 1e-12 * (std::abs(middle) + reach + 1);
  range.lo = std::max(range.lo, middle - reach - slack);
  range.hi = std::min(range.hi, middle + reach + slack);
  return range;
}

}  // namespace meso::implicit
