// SPDX-License-Identifier: Apache-2.0
#include "place_of_solid.hpp"

#include <cmath>
#include <numbers>

#include "meso/implicit/field.hpp"

namespace meso::sdf {

using expr::Op;
using implicit::Field;
using implicit::Term;

namespace {

Term fraction_of_turn(const Term& y, const Term& x, double units) {
  return (units / (2 * std::numbers::pi)) * Term::apply(Op::atan2, {y, x});
}

}  // namespace

std::array<Term, 3> bent(const Instruction& instruction) {
  const auto& n = instruction.numbers;
  const Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);
  const Term around_axis = x * x + y * y;
  switch (instruction.verb) {
    case Verb::cylindrical:
      return {sqrt(around_axis), fraction_of_turn(y, x, n[0]), z};
    case Verb::helix:
      return {sqrt(around_axis), fraction_of_turn(y, x, n[0]), z - fraction_of_turn(y, x, n[1])};
    case Verb::spherical:
      // Half a turn from pole to pole.
      return {sqrt(around_axis + z * z), fraction_of_turn(y, x, n[0]),
              fraction_of_turn(sqrt(around_axis), z, 2 * n[1])};
    default:
      break;
  }
  std::array<Term, 3> folded{x, y, z};
  for (std::size_t a = 0; a < 3; ++a)
    if (n[a] > 0) folded[a] = folded[a] - n[a] * Term::apply(Op::floor, {(1 / n[a]) * folded[a] + 0.5});
  return folded;
}

std::array<Term, 3> place_of_solid(const Instruction& instruction) {
  const auto& n = instruction.numbers;
  const Vec3 v{n[0], n[1], n[2]};
  std::array<Term, 3> place;
  for (std::size_t a = 0; a < 3; ++a) {
    // A field that is a coordinate is moved as any other.
    const Field coordinate = Field::from_term(Term::coordinate(a));
    switch (instruction.verb) {
      case Verb::move:
        place[a] = coordinate.translated(v).term();
        break;
      case Verb::rotate:
        place[a] = coordinate.rotated(v, n[3]).term();
        break;
      case Verb::orient:
        place[a] = coordinate.oriented(v).term();
        break;
      case Verb::mirror:
        place[a] = coordinate.mirrored(v).term();
        break;
      case Verb::scale:  // which would multiply values, too
        place[a] = (1 / v[a]) * Term::coordinate(a);
        break;
      case Verb::cylindrical:
      case Verb::spherical:
      case Verb::helix:
      case Verb::repeat:
        return bent(instruction);
      default:
        place[a] = Term::coordinate(a);
    }
  }
  return place;
}

}  // namespace meso::sdf
