// SPDX-License-Identifier: Apache-2.0
// axes, rigid placements, transforms.
#include <algorithm>
#include <cmath>

#include "families.hpp"
#include "meso/base/vec.hpp"

namespace meso {
namespace {

constexpr double rigid_tolerance = 1e-9;
constexpr double independence_tolerance = 1e-9;

/// Takes from `v` what lies in the span of the orthonormal `basis`.
Vec3 remainder(Vec3 v, const std::vector<Vec3>& basis) {
  for (const Vec3 b : basis) v = v - dot(v, b) * b;
  return v;
}

void check_direction(Context& c, const Axis& axis, std::vector<Vec3>& linear, std::vector<Vec3>& distance) {
  const auto x = c.constant(axis.x, 0), y = c.constant(axis.y, 0), z = c.constant(axis.z, 0);
  if (!x || !y || !z) return;
  const Vec3 direction{*x, *y, *z};
  const double length = norm(direction);
  if (length == 0) {
    c.report(Code::direction_zero, axis, "", {});
    return;
  }
  if (axis.kind == AxisKind::circular) return;
  std::vector<Vec3>& basis = axis.kind == AxisKind::linear ? linear : distance;
  const Vec3 rest = remainder(direction / length, basis);
  if (norm(rest) <= independence_tolerance)
    c.report(Code::axes_dependent, axis, "", {axis.name.text, axis.kind == AxisKind::linear ? "linear" : "distance"});
  else
    basis.push_back(rest / norm(rest));
}

void check_axes(Context& c, const CoordinateSystem& system) {
  if (system.axes.empty())
    c.report(Code::content_needed, system, "", {"coordinateSystem", "at least one <axis>", "none"});
  Scope names;
  std::vector<Vec3> linear, distance;
  for (const Axis& axis : system.axes) {
    if (c.check_name(axis, "name", axis.name.text)) c.declare(names, axis, "name", axis.name.text, "an axis");
    if (axis.kind == AxisKind::scalar) {
      if (axis.x || axis.y || axis.z) c.report(Code::axis_without_direction, axis, "", {axis.name.text});
      continue;
    }
    bool good = c.check(axis, "x", axis.x, c.parameters);
    good = c.check(axis, "y", axis.y, c.parameters) && good;
    good = c.check(axis, "z", axis.z, c.parameters) && good;
    if (good) check_direction(c, axis, linear, distance);
  }
}

std::optional<Mat3> linear_part(Context& c, const Element& element, const ExpressionList& matrix, const Scope& scope) {
  if (!c.check(element, "matrix", matrix, scope)) return std::nullopt;
  const std::size_t entries = split_count(matrix);
  if (entries != 12) {
    c.report(Code::expression_list_count, element, "matrix", {"12", std::to_string(entries)});
    return std::nullopt;
  }
  const auto v = c.constants(matrix);
  if (!v) return std::nullopt;
  return Mat3{{(*v)[0], (*v)[1], (*v)[2], (*v)[4], (*v)[5], (*v)[6], (*v)[8], (*v)[9], (*v)[10]}};
}

void check_rigid(Context& c, const Placement& placement) {
  if (placement.mirror.value_or(false))
    c.report(Code::attribute_ineffective, placement, "mirror",
             {"mirror", "in a coordinate system: its placement is rigid"});
  const auto m = linear_part(c, placement, placement.matrix, c.parameters);
  if (!m) return;
  const Mat3 gram = transposed(*m) * *m;
  double worst = 0;
  for (std::size_t i = 0; i < 9; ++i) worst = std::max(worst, std::abs(gram.m[i] - Mat3{}.m[i]));
  if (!(worst <= rigid_tolerance))
    c.report(Code::placement_not_rigid, placement, "matrix", {"its columns are not orthonormal"});
  else if (determinant(*m) < 0)
    c.report(Code::placement_not_rigid, placement, "matrix", {"it is a reflection"});
}

const std::vector<Axis>& global_axes() {
  static const std::vector<Axis> axes = [] {
    std::vector<Axis> a(3);
    a[0].name = {"x"};
    a[0].x = Expression{"1"};
    a[1].name = {"y"};
    a[1].y = Expression{"1"};
    a[2].name = {"z"};
    a[2].z = Expression{"1"};
    return a;
  }();
  return axes;
}

}  // namespace

void check_transform(Context& c, const Element& element, const ExpressionList& matrix, std::optional<bool> mirror,
                     const Scope& scope) {
  const auto m = linear_part(c, element, matrix, scope);
  if (!m) return;
  const double size = norm(m->column(0)) * norm(m->column(1)) * norm(m->column(2));
  const double d = determinant(*m);
  const bool singular = std::abs(d) <= 1e-12 * size;
  if (singular || (d < 0 && !mirror.value_or(false)))
    c.report(Code::transform_determinant, element, "matrix", {format_number(singular ? 0 : d)});
}

void check_placement(Context& c, const std::optional<Placement>& placement, const Scope& scope) {
  if (placement) check_transform(c, *placement, placement->matrix, placement->mirror, scope);
}

const std::vector<Axis>* axes_of(const Context& c, const std::optional<Ref<CoordinateSystem>>& ref) {
  if (!ref) return &global_axes();
  const CoordinateSystem* system = c.find(*ref);
  return system != nullptr ? &system->axes : nullptr;
}

std::optional<std::size_t> find_axis(Context& c, const std::vector<Axis>& axes, std::string_view system,
                                     const Element& element, std::string_view attribute, const Name& name) {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == name; });
  if (found != axes.end()) return static_cast<std::size_t>(found - axes.begin());
  std::string known;
  for (const Axis& a : axes) known += (known.empty() ? "; its axes are " : ", ") + a.name.text;
  c.report(Code::link_unknown_axis, element, attribute,
           {system.empty() ? std::string("the global coordinate system")
                           : "the coordinate system '" + std::string(system) + "'",
            name.text, std::move(known)});
  return std::nullopt;
}

void check_coordinate_systems(Context& c) {
  for (const CoordinateSystem& system : c.document.coordinate_systems) {
    if (system.placement) check_rigid(c, *system.placement);
    check_axes(c, system);
  }
}

}  // namespace meso
