// SPDX-License-Identifier: Apache-2.0
// CSG trees and imports, in the scope of the macrostructure or unit cell that owns them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "families.hpp"
#include "meso/base/polyhedron.hpp"
#include "meso/expr/expression.hpp"
#include "meso/expr/operations.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

class CsgCheck {
 public:
  CsgCheck(Context& c, const Scope& scope) : c_(c), scope_(scope) {}

  void operands(const Element& owner, std::string_view name, const std::vector<CsgNode>& nodes) {
    if (nodes.empty()) c_.report(Code::content_needed, owner, "", {std::string(name), "at least one body", "none"});
    for (const CsgNode& node : nodes) std::visit(*this, node.value);
  }

  void operator()(const BoxPrimitive& e) { positive(e, {{"dx", &e.dx}, {"dy", &e.dy}, {"dz", &e.dz}}); }
  void operator()(const SpherePrimitive& e) { positive(e, {{"radius", &e.radius}}); }
  void operator()(const EllipsoidPrimitive& e) { positive(e, {{"rx", &e.rx}, {"ry", &e.ry}, {"rz", &e.rz}}); }
  void operator()(const CylinderPrimitive& e) {
    positive(e, {{"radius", &e.radius}});
    length(e);
  }
  void operator()(const ConePrimitive& e) {
    c_.require_not_negative(e, "radius1", e.radius1);
    c_.require_not_negative(e, "radius2", e.radius2);
    if (c_.constant(e.radius1) == 0.0 && c_.constant(e.radius2) == 0.0)
      c_.report(Code::body_degenerate, e, "", {"both radii are 0"});
    length(e);
  }
  void operator()(const TorusPrimitive& e) {
    positive(e, {{"majorRadius", &e.major_radius}, {"minorRadius", &e.minor_radius}});
    const auto major = c_.constant(e.major_radius), minor = c_.constant(e.minor_radius);
    if (major && minor && *major > 0 && *minor > 0 && !(*major > *minor))
      c_.report(Code::torus_radii, e, "majorRadius", {format_number(*major), format_number(*minor)});
    if (e.ax || e.ay || e.az) direction(e, e.ax, e.ay, e.az);
  }
  void operator()(const ExtrusionPrimitive& e) {
    positive(e, {{"height", &e.height}});
    if (e.points.size() < 3)
      c_.report(Code::content_needed, e, "", {"extrusion", "at least three <point>", std::to_string(e.points.size())});
    else if (area(e) == 0.0)
      c_.report(Code::body_degenerate, e, "", {"the polygon has no area"});
  }
  void operator()(const WedgePrimitive& e) {
    positive(e, {{"dx", &e.dx}, {"dy", &e.dy}, {"dz", &e.dz}});
    c_.require_not_negative(e, "topDx", e.top_dx);
    c_.require_not_negative(e, "topDy", e.top_dy);
  }
  void operator()(const RevolutionPrimitive& e);
  void operator()(const PolyhedronPrimitive& e);
  void operator()(const VolumeElementPrimitive& e);
  template <BooleanOperation O>
  void operator()(const CsgBoolean<O>& e) {
    operands(e, element_name<CsgBoolean<O>>, e.operands);
  }
  void operator()(const CsgTransform& e) {
    check_transform(c_, e, e.matrix, e.mirror, scope_);
    operands(e, "transform", e.operands);
  }
  void operator()(const CsgTranslate& e) { operands(e, "translate", e.operands); }
  void operator()(const CsgRotate& e) {
    direction(e, e.x, e.y, e.z);
    operands(e, "rotate", e.operands);
  }
  void operator()(const CsgScale& e) {
    check_scale(c_, e, e.x, e.y, e.z, e.factor);
    operands(e, "scale", e.operands);
  }

 private:
  struct Size {
    std::string_view attribute;
    const Expression* value;
  };
  void positive(const Element& e, std::initializer_list<Size> sizes) {
    for (const Size& size : sizes) c_.require_positive(e, size.attribute, *size.value);
  }
  void direction(const Element& e, const std::optional<Expression>& x, const std::optional<Expression>& y,
                 const std::optional<Expression>& z) {
    if (c_.is_zero(x, y, z)) c_.report(Code::direction_zero, e, "", {});
  }
  template <class E>
  void length(const E& e) {
    const std::array ends{c_.constant(e.x1), c_.constant(e.y1), c_.constant(e.z1),
                          c_.constant(e.x2), c_.constant(e.y2), c_.constant(e.z2)};
    if (std::any_of(ends.begin(), ends.end(), [](const auto& v) { return !v; })) return;
    if (ends[0] == ends[3] && ends[1] == ends[4] && ends[2] == ends[5])
      c_.report(Code::body_degenerate, e, "", {"both ends are the same point"});
  }
  /// If all points are constant.
  [[nodiscard]] std::optional<double> area(const ExtrusionPrimitive& e) const {
    std::vector<Point2> points;
    for (const ProfilePoint& p : e.points) {
      const auto x = c_.constant(p.x), y = c_.constant(p.y);
      if (!x || !y) return std::nullopt;
      points.emplace_back(*x, *y);
    }
    return polygon_area(points);
  }
  /// If it is constant and names corners by whole numbers, else reported.
  std::optional<std::vector<std::size_t>> corners(const PolyhedronFace& face);

  Context& c_;
  const Scope& scope_;
};

void CsgCheck::operator()(const RevolutionPrimitive& e) {
  if (e.points.size() < 3) {
    c_.report(Code::content_needed, e, "", {"revolution", "at least three <point>", std::to_string(e.points.size())});
    return;
  }
  std::vector<Point2> points;
  for (const MeridianPoint& p : e.points) {
    c_.require_not_negative(p, "r", p.r);
    const auto r = c_.constant(p.r), z = c_.constant(p.z);
    if (r && z) points.emplace_back(*r, *z);
  }
  if (points.size() < e.points.size()) return;
  if (const auto fault = polygon_fault(points, 0)) c_.report(Code::revolution_profile, e, "", {*fault});
}

std::optional<std::vector<std::size_t>> CsgCheck::corners(const PolyhedronFace& face) {
  if (!c_.check(face, "vertices", face.vertices, scope_)) return std::nullopt;
  const auto values = c_.constants(face.vertices);
  if (!values) {
    c_.report(Code::polyhedron_index, face, "vertices", {"a corner by a value that differs from cell to cell"});
    return std::nullopt;
  }
  std::vector<std::size_t> indices;
  for (const double value : *values) {
    const double n = expr::snap_to_integer(value);
    if (n == std::round(n) && n >= 0 && n <= 0x1p53) indices.push_back(static_cast<std::size_t>(n));
  }
  if (indices.size() == values->size()) return indices;
  require_whole(c_, face, "vertices", face.vertices, 0);
  return std::nullopt;
}

void CsgCheck::operator()(const PolyhedronPrimitive& e) {
  const auto least_four = [&](std::string_view what, std::size_t count) {
    if (count < 4)
      c_.report(Code::content_needed, e, "",
                {"polyhedron", "at least four <" + std::string(what) + ">", std::to_string(count)});
    return count >= 4;
  };
  if (!least_four("vertex", e.vertices.size()) || !least_four("face", e.faces.size())) return;
  Polyhedron body;
  for (const PolyhedronVertex& v : e.vertices) {
    const auto x = c_.constant(v.x), y = c_.constant(v.y), z = c_.constant(v.z);
    if (x && y && z) body.vertices.push_back({*x, *y, *z});
  }
  for (const PolyhedronFace& face : e.faces)
    if (auto indices = corners(face)) body.faces.push_back(std::move(*indices));
  if (body.vertices.size() < e.vertices.size() || body.faces.size() < e.faces.size()) return;
  if (auto fault = polyhedron_fault(body))
    c_.report(fault->code, e.faces[fault->face], "vertices", std::move(fault->args));
}

void CsgCheck::operator()(const VolumeElementPrimitive& e) {
  if (e.ranges.size() != 3)
    c_.report(Code::content_needed, e, "", {"volumeElement", "three <range>", std::to_string(e.ranges.size())});
  const CoordinateSystem* system = c_.find(e.coordinate_system);
  std::vector<bool> used(system != nullptr ? system->axes.size() : 0, false);
  for (const AxisRange& range : e.ranges) {
    const auto from = c_.constant(range.from), to = c_.constant(range.to);
    const bool is_range = from && to && *from < *to;
    if (from && to && !is_range)
      c_.report(Code::range_empty, range, "from", {format_number(*from), format_number(*to)});
    if (system == nullptr) continue;
    const auto position = find_axis(c_, system->axes, system->id.text, range, "axis", range.axis);
    if (!position) continue;
    const Axis& axis = system->axes[*position];
    const AxisKind kind = axis.kind;
    if (used[*position]) c_.report(Code::axis_twice, range, "axis", {range.axis.text});
    used[*position] = true;
    if (kind == AxisKind::scalar) c_.report(Code::scalar_axis, range, "axis", {range.axis.text});
    if (kind == AxisKind::distance && from && *from < 0)
      c_.report(Code::distance_negative, range, "from", {range.axis.text, format_number(*from)});
    constexpr double full_turn = 2 * std::numbers::pi;
    if (kind == AxisKind::circular && is_range && *to - *from > full_turn * (1 + 1e-12))
      c_.report(Code::range_full_turn, range, "to", {format_number(*to - *from)});
  }
}

enum class UnitRule { needed, refused };

std::optional<UnitRule> unit_rule(std::string_view extension) {
  static constexpr std::array<std::pair<std::string_view, UnitRule>, 9> table{{{"step", UnitRule::refused},
                                                                               {"stp", UnitRule::refused},
                                                                               {"iges", UnitRule::refused},
                                                                               {"igs", UnitRule::refused},
                                                                               {"stl", UnitRule::needed},
                                                                               {"obj", UnitRule::needed},
                                                                               {"ply", UnitRule::needed},
                                                                               {"off", UnitRule::needed},
                                                                               {"brep", UnitRule::needed}}};
  for (const auto& [known, rule] : table)
    if (known == extension) return rule;
  return std::nullopt;
}

/// Lower case, without the point.
std::string extension_of(std::string_view href) {
  const std::size_t name = href.rfind('/') + 1;  // npos + 1 is 0
  const std::size_t point = href.rfind('.');
  std::string extension(point == std::string_view::npos || point < name ? std::string_view() : href.substr(point + 1));
  for (char& letter : extension)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return extension;
}

}  // namespace

void check_csg(Context& c, const CsgBody& body, const Scope& scope) {
  walk(body, ExpressionCheck{c, scope});
  CsgCheck(c, scope).operands(body, "csg", body.operands);
}

void check_import(Context& c, const ImportBody& body, const Scope& scope) {
  check_placement(c, body.transform, scope);
  const std::string extension = extension_of(body.href.text);
  const auto rule = unit_rule(extension);
  if (!rule)
    c.report(Code::import_format, body, "href", {body.href.text});
  else if (*rule == UnitRule::needed && !body.unit)
    c.report(Code::import_unit_needed, body, "", {"." + extension});
  else if (*rule == UnitRule::refused && body.unit)
    c.report(Code::import_unit_refused, body, "unit", {"." + extension});
}

void check_scale(Context& c, const Element& element, const std::optional<Expression>& x,
                 const std::optional<Expression>& y, const std::optional<Expression>& z,
                 const std::optional<Expression>& factor) {
  const bool has_three = x || y || z;
  if (has_three == factor.has_value())
    c.report(Code::choice_needed, element, "", {"factor or x y z", factor ? "both" : "none"});
  c.require_positive(element, "factor", factor);
  c.require_positive(element, "x", x);
  c.require_positive(element, "y", y);
  c.require_positive(element, "z", z);
}

}  // namespace meso
