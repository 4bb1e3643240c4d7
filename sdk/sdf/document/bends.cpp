// SPDX-License-Identifier: Apache-2.0
#include "bends.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meso/base/number.hpp"
#include "region.hpp"

namespace meso::sdf {
namespace {

using std::numbers::pi;

double farthest(double from, double to) { return std::max(std::abs(from), std::abs(to)); }

double reach(const Box3& region, bool is_spherical) {
  const double around = std::hypot(farthest(region.min.x, region.max.x), farthest(region.min.y, region.max.y));
  return is_spherical ? std::hypot(around, farthest(region.min.z, region.max.z)) : around;
}

Axis axis(const char* name, AxisKind kind, Vec3 direction) {
  Axis made{.name = {name}, .kind = kind};
  const auto set = [](std::optional<Expression>& to, double v) {
    if (v != 0) to = Expression{format_number(v)};
  };
  set(made.x, direction.x), set(made.y, direction.y), set(made.z, direction.z);
  return made;
}

Loop once(const char* index, const Axis& along, const std::string& start, const std::string& spacing) {
  return {
      .index = {index}, .count = {"1"}, .axis = along.name, .start = Expression{start}, .spacing = Expression{spacing}};
}

}  // namespace

Bend bend_of(const Instruction& word, const Box3& region) {
  const bool is_spherical = word.verb == Verb::spherical;
  Bend bend{.is_spherical = is_spherical, .turn = word.numbers[0], .poles = is_spherical ? word.numbers[1] : 0};
  const double far = reach(region, is_spherical), half = std::abs(bend.turn) / 2;
  const Box3 roomy = with_room({{0, 0, region.min.z}, {far, far, region.max.z}});
  bend.solid = {{0, -half, roomy.min.z}, {roomy.max.x, half, roomy.max.z}};
  if (is_spherical) bend.solid.min.z = std::min(0.0, bend.poles), bend.solid.max.z = std::max(0.0, bend.poles);
  return bend;
}

Box3 before_shear(const Box3& sheared, double rise) {
  const Vec3 by{0, 0, std::abs(rise) / 2};
  return {sheared.min - by, sheared.max + by};
}

void write_bend(const Bend& bend, const std::string& prefix, CoordinateSystem& system, CellBox& box, Pattern& pattern) {
  const auto text = [](double v) { return format_number(v); };
  const std::string turn = (bend.turn < 0 ? "-" : "") + prefix + "Turn";
  const std::string poles = (bend.poles < 0 ? "-" : "") + prefix + "Poles";
  const Box3& solid = bend.solid;
  const bool is_spherical = bend.is_spherical;
  // From the north pole, which lies on z, down: a turn about y.
  system.axes = {axis("r", AxisKind::distance, is_spherical ? Vec3{0, 0, 1} : Vec3{1, 0, 0}),
                 axis("phi", AxisKind::circular, {0, 0, bend.turn < 0 ? -1.0 : 1.0}),
                 is_spherical ? axis("theta", AxisKind::circular, {0, bend.poles < 0 ? -1.0 : 1.0, 0})
                              : axis("height", AxisKind::linear, {0, 0, 1})};
  box.x = {"0"}, box.dx = {text(solid.max.x)};
  box.y = Expression{(bend.turn < 0 ? "" : "-") + prefix + "Turn/2"}, box.dy = {turn};
  const double height = solid.max.z - solid.min.z;
  box.z = Expression{!is_spherical ? text(solid.min.z) : bend.poles < 0 ? prefix + "Poles" : "0"};
  box.dz = {is_spherical ? poles : text(height)};
  pattern.coordinate_system = Ref<CoordinateSystem>{system.id.text};
  pattern.mapping = CellMapping::conformal;
  pattern.loops = {once("i", system.axes[0], "0", text(solid.max.x)), once("j", system.axes[1], "-pi", "2*pi"),
                   is_spherical ? once("k", system.axes[2], bend.poles < 0 ? "-pi" : "0", "pi")
                                : once("k", system.axes[2], text(solid.min.z), text(height))};
}

std::optional<Bend> read_bend(const CoordinateSystem& system, const CellBox& box, const Pattern& pattern,
                              const std::function<double(const Expression&)>& value) {
  const auto& axes = system.axes;
  if (system.parent || system.placement || axes.size() != 3 || pattern.loops.size() != 3) return std::nullopt;
  const auto given = [&](const std::optional<Expression>& e) { return e ? value(*e) : 0; };
  const auto points = [&](std::size_t a, AxisKind kind, Vec3 direction) {
    return axes[a].kind == kind && Vec3{given(axes[a].x), given(axes[a].y), given(axes[a].z)} == direction;
  };
  // What the sides of the box become: from `start`, `step` long.
  std::array<double, 3> start{}, step{};
  for (const Loop& loop : pattern.loops) {
    const auto along = std::ranges::find_if(axes, [&](const Axis& a) { return loop.axis && *loop.axis == a.name; });
    if (along == axes.end() || !loop.spacing || value(loop.count) != 1) return std::nullopt;
    const auto a = static_cast<std::size_t>(along - axes.begin());
    start[a] = given(loop.start), step[a] = value(*loop.spacing);
  }
  const Vec3 corner{given(box.x), given(box.y), given(box.z)}, size{value(box.dx), value(box.dy), value(box.dz)};
  const bool is_spherical = axes[2].kind == AxisKind::circular;
  const auto as_it_is = [&](std::size_t a) { return corner[a] == start[a] && size[a] == step[a]; };
  const bool outwards =
      points(0, AxisKind::distance, is_spherical ? Vec3{0, 0, 1} : Vec3{1, 0, 0}) && as_it_is(0) && corner.x == 0;
  const bool left = points(1, AxisKind::circular, {0, 0, 1}), right = points(1, AxisKind::circular, {0, 0, -1});
  const bool turns = (left || right) && start[1] == -pi && step[1] == 2 * pi && corner.y == -size.y / 2;
  if (!outwards || !turns) return std::nullopt;
  Bend bend{.is_spherical = is_spherical, .turn = left ? size.y : -size.y, .solid = {corner, corner + size}};
  if (!is_spherical) return points(2, AxisKind::linear, {0, 0, 1}) && as_it_is(2) ? std::optional(bend) : std::nullopt;
  const bool down = points(2, AxisKind::circular, {0, 1, 0}) && start[2] == 0 && corner.z == 0;
  const bool up = points(2, AxisKind::circular, {0, -1, 0}) && start[2] == -pi && corner.z == -size.z;
  if ((!down && !up) || step[2] != pi) return std::nullopt;
  bend.poles = down ? size.z : -size.z;
  return bend;
}

bool shows_all(const Bend& bend, const Box3& region) {
  const bool in_height = bend.is_spherical || (bend.solid.min.z <= region.min.z && bend.solid.max.z >= region.max.z);
  return in_height && bend.solid.max.x >= reach(region, bend.is_spherical);
}

std::string shear_matrix(const std::string& prefix) {
  return "1, 0, 0, 0, 0, 1, 0, 0, 0, " + prefix + "Rise/" + prefix + "Turn, 1, 0";
}

}  // namespace meso::sdf
