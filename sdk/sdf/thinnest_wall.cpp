// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/thinnest_wall.hpp"

#include <algorithm>
#include <cmath>

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
    solid.wall = solid.unit_slope && thickness > 0 ? std::optional(Wall{&instruction, thickness}) : std::nullopt;
  };
  switch (instruction.verb) {
    case Verb::shell:
      return new_wall(n[0]);
    case Verb::eccentric_shell:
      return new_wall(n[1] - n[0]);
    case Verb::complement:  // what was a wall is a gap
      return solid.wall.reset();
    case Verb::offset:
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

}  // namespace

std::optional<Wall> thinnest_wall(const Program& program) {
  std::vector<Solid> stack;
  for (const Instruction& instruction : program.instructions) {
    switch (instruction.verb) {
      case Verb::surface:
      case Verb::expression:
        stack.push_back({.unit_slope = false});
        break;
      case Verb::ball:
      case Verb::cylinder:
      case Verb::box:
      case Verb::cone:
      case Verb::torus:
      case Verb::capsule:
      case Verb::half_space:
      case Verb::file:
        stack.push_back({});
        break;
      case Verb::union_of:
      case Verb::intersection:
      case Verb::difference: {
        const Solid above = stack.back();
        stack.pop_back();
        Solid& below = stack.back();
        below.unit_slope = below.unit_slope && above.unit_slope;
        if (instruction.verb != Verb::difference) below.wall = thinner(below.wall, above.wall);
        break;
      }
      default:
        change(stack.back(), instruction);
    }
  }
  return stack.back().wall;
}

}  // namespace meso::sdf
