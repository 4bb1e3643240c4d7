// SPDX-License-Identifier: Apache-2.0
#include "polygon_term.hpp"

#include <algorithm>

#include "meso/eval/bounds.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

Term apply(Op op, const Term& a, const Term& b) { return Term::apply(op, {a, b}); }
Term sum(std::vector<Term> terms) {
  // As a balanced tree, so that thousands of sides are no deep tree.
  while (terms.size() > 1) {
    std::vector<Term> next;
    for (std::size_t i = 0; i + 1 < terms.size(); i += 2) next.push_back(terms[i] + terms[i + 1]);
    if (terms.size() % 2 == 1) next.push_back(terms.back());
    terms = std::move(next);
  }
  return terms.front();
}
Term least(std::vector<Term> terms) {
  while (terms.size() > 1) {
    std::vector<Term> next;
    for (std::size_t i = 0; i + 1 < terms.size(); i += 2) next.push_back(min(terms[i], terms[i + 1]));
    if (terms.size() % 2 == 1) next.push_back(terms.back());
    terms = std::move(next);
  }
  return terms.front();
}

/// Negative inside: an odd number of sides crosses the ray to the right.
Term polygons(std::span<const Side> sides, const Term& x, const Term& y) {
  const Term zero = Term::constant(0), one = Term::constant(1);
  std::vector<Term> squares, crossings;
  for (const Side& side : sides) {
    const auto [ax, ay] = side.from;
    const auto [bx, by] = side.to;
    const double ex = bx - ax, ey = by - ay, length2 = ex * ex + ey * ey;
    const Term wx = x - ax, wy = y - ay;
    const Term along = Term::apply(Op::clamp, {(ex / length2) * wx + (ey / length2) * wy, zero, one});
    const Term dx = wx - ex * along, dy = wy - ey * along;
    squares.push_back(dx * dx + dy * dy);
    if (ay == by) continue;
    const auto [low, high] = std::minmax(ay, by);
    const Term beside = apply(Op::logical_and, apply(Op::greater_equal, y, Term::constant(low)),
                              apply(Op::less, y, Term::constant(high)));
    const Term left = apply(Op::less, x, (ex / ey) * wy - -ax);
    crossings.push_back(apply(Op::logical_and, beside, left));
  }
  const Term odd = apply(Op::mod, sum(std::move(crossings)), Term::constant(2));
  const Term distance = sqrt(least(std::move(squares)));
  return Term::apply(Op::select, {odd, -distance, distance});
}

}  // namespace

Field extrusion(std::span<const Side> sides, double z, double height) {
  Box3 box;
  for (const Side& side : sides) box.extend({side.from.first, side.from.second, 0});
  const Vec3 half{(box.max.x - box.min.x) / 2, (box.max.y - box.min.y) / 2, height / 2};
  const Vec3 middle{box.min.x + half.x, box.min.y + half.y, z + half.z};
  const Field profile = Field::from_term(polygons(sides, Term::coordinate(0), Term::coordinate(1)));
  const Field slab = intersection_of(Field::half_space({0, 0, 1}, z + height), Field::half_space({0, 0, -1}, -z));
  // The box holds the body and changes nothing but bounds().
  return intersection_of(intersection_of(profile, slab), Field::box(half).translated(middle));
}

namespace {

std::vector<Side> sides_of(const std::vector<Point2>& corners) {
  std::vector<Side> sides;
  for (std::size_t i = 0; i < corners.size(); ++i) sides.push_back({corners[i], corners[(i + 1) % corners.size()]});
  return sides;
}

}  // namespace

Field extrusion(const eval::ExtrusionShape& shape) { return extrusion(sides_of(shape.points), shape.z, shape.height); }

Field revolution(const eval::RevolutionShape& shape) {
  std::vector<Side> sides = sides_of(shape.points);
  // Sides on the axis bound nothing, and no point has a smaller r.
  std::erase_if(sides, [](const Side& side) { return side.from.first == 0 && side.to.first == 0; });
  const Term x = Term::coordinate(0), y = Term::coordinate(1);
  const Box3 box = *eval::bounds(eval::Shape{shape});
  const Field profile = Field::from_term(polygons(sides, sqrt(x * x + y * y), Term::coordinate(2)));
  const Vec3 half = 0.5 * (box.max - box.min);
  return intersection_of(profile, Field::box(half).translated(box.min + half));
}

}  // namespace meso::implicit
