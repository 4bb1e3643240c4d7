// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/thinnest_wall.hpp"

#include <algorithm>
#include <cmath>

#include "meso/sdf/solid_tree.hpp"

namespace meso::sdf {
namespace {

struct Solid {
  bool unit_slope = true;  ///< f changes by 1 a millimetre nearly everywhere: levels are lengths
  std::optional<Wall> wall{};
};

std::optional<Wall> thinner(const std::optional<Wall>& a, const std::optional<Wall>& b) {
  return !a || (b && b->thickness < a->thickness) ? b : a;
}

void change(Solid& solid, const Instruction& instruction) {
  const auto& n = instruction.numbers;
  const auto new_wall = [&](double thickness) {
    const bool is_known = solid.unit_slope && instruction.text.empty() && thickness > 0;
    solid.wall = is_known ? std::optional(Wall{&instruction, thickness}) : std::nullopt;
    if (!instruction.text.empty()) solid.unit_slope = false;
  };
  switch (instruction.verb) {
    case Verb::shell:
      return new_wall(n[0]);
    case Verb::eccentric_shell:
      return new_wall(n[1] - n[0]);
    case Verb::complement:  // what was a wall is a gap
      return solid.wall.reset();
    case Verb::density:
    case Verb::cylindrical:
    case Verb::spherical:
    case Verb::helix:
      solid = {.unit_slope = false};
      return;
    case Verb::offset:
      if (!instruction.text.empty()) solid = {.unit_slope = false};
      if (!solid.wall) return;
      solid.wall->thickness += 2 * n[0];
      if (!solid.unit_slope || solid.wall->thickness <= 0) solid.wall.reset();
      return;
    case Verb::scale: {
      const auto [least, most] = std::minmax({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
      if (solid.wall) solid.wall->thickness *= most;
      solid.unit_slope = solid.unit_slope && least == most;
      return;
    }
    default:
      return;
  }
}

void join(Solid& below, const Solid& above, Verb verb) {
  below.unit_slope = below.unit_slope && above.unit_slope;
  if (verb == Verb::blend) below = {.unit_slope = false};
  if (verb == Verb::union_of || verb == Verb::intersection || verb == Verb::smooth_union)
    below.wall = thinner(below.wall, above.wall);
}

}  // namespace

std::optional<Wall> thinnest_wall(const Program& program) {
  const SolidTree tree = solid_tree(program);
  std::vector<Solid> solids;
  for (const SolidTree::Node& node : tree.nodes) {
    const Verb verb = node.made_by->verb;
    if (node.of.empty()) {
      const bool is_level_set = verb == Verb::surface || verb == Verb::expression;
      solids.push_back({.unit_slope = !is_level_set});
      if (verb == Verb::strut) solids.back().wall = Wall{node.made_by, 2 * node.made_by->numbers[0]};
      continue;
    }
    Solid made = solids[node.of[0]];
    if (node.of.size() == 2)
      join(made, solids[node.of[1]], verb);
    else
      change(made, *node.made_by);
    solids.push_back(made);
  }
  return solids.back().wall;
}

}  // namespace meso::sdf
