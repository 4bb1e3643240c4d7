// SPDX-License-Identifier: Apache-2.0
// CSG trees and imports, in the scope of the macrostructure or unit cell that owns them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "families.hpp"
#include "meso/base/vec.hpp"
#include "meso/expr/expression.hpp"
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
  /// Twice the signed area, if all points are constant.
  [[nodiscard]] std::optional<double> area(const ExtrusionPrimitive& e) const {
    std::vector<Vec3> points;
    for (const ProfilePoint& p : e.points) {
      const auto x = c_.constant(p.x), y = c_.constant(p.y);
      if (!x || !y) return std::nullopt;
      points.push_back({*x, *y, 0});
    }
    double sum = 0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i)
      sum += cross(points[i] - points[0], points[i + 1] - points[0]).z;
    return sum;
  }

  Context& c_;
  const Scope& scope_;
};

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
    const AxisKind kind = system->axes[*position].kind;
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
  static constexpr std::array<std::pair<std::string_view, UnitRule>, 8> table{{{"step", UnitRule::refused},
                                                                               {"stp", UnitRule::refused},
                                                                               {"iges", UnitRule::refused},
                                                                               {"igs", UnitRule::refused},
                                                                               {"stl", UnitRule::needed},
                                                                               {"obj", UnitRule::needed},
                                                                               {"ply", UnitRule::needed},
                                                                               {"off", UnitRule::needed}}};
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
