// SPDX-License-Identifier: Apache-2.0
#include "volume_element.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "coordinate_inverse.hpp"
#include "meso/implicit/document_field.hpp"

namespace meso::implicit {
namespace {

/// Where lengths are fixed, P runs along arcs; where angles are, it is linear. So the box of P at the ends of the
/// lengths and at closely spaced angles holds everything but the arcs' sagittas.
Box3 box_around(const eval::VolumeElementShape& shape) {
  constexpr int arcs = 96;
  const auto& axes = shape.system->axes();
  double arm = 0, sagitta = 0;
  std::array<int, 3> steps{};
  for (std::size_t i = 0; i < 3; ++i) {
    const AxisKind kind = axes[shape.axes[i]].kind;
    steps[i] = kind == AxisKind::circular ? arcs : 1;
    if (kind == AxisKind::distance) arm += std::max(std::abs(shape.from[i]), std::abs(shape.to[i]));
    if (kind == AxisKind::circular) sagitta += 1 - std::cos((shape.to[i] - shape.from[i]) / arcs / 2);
  }
  Box3 box;
  std::vector<double> q(axes.size(), 0);
  for (int a = 0; a <= steps[0]; ++a)
    for (int b = 0; b <= steps[1]; ++b)
      for (int c = 0; c <= steps[2]; ++c) {
        const std::array<int, 3> at{a, b, c};
        for (std::size_t i = 0; i < 3; ++i)
          q[shape.axes[i]] = shape.from[i] + (shape.to[i] - shape.from[i]) * at[i] / steps[i];
        box.extend(shape.system->point(q));
      }
  const double by = arm * sagitta + seam;
  return {box.min - Vec3{by, by, by}, box.max + Vec3{by, by, by}};
}

}  // namespace

double shortest_edge_of(const eval::VolumeElementShape& shape) {
  const auto corner = [&](unsigned which) {
    std::vector<double> q(shape.system->axes().size(), 0);
    for (std::size_t i = 0; i < 3; ++i) q[shape.axes[i]] = which >> i & 1U ? shape.to[i] : shape.from[i];
    return shape.system->point(q);
  };
  double shortest = HUGE_VAL;
  for (unsigned axis = 0; axis < 3; ++axis) {
    double longest = 0;  // at an axis of a turn, one of four is a point
    for (unsigned which = 0; which < 8; ++which)
      longest = std::max(longest, norm(corner(which) - corner(which ^ 1U << axis)));
    if (longest > 0) shortest = std::min(shortest, longest);
  }
  return shortest;
}

std::optional<Field> volume_element(const eval::VolumeElementShape& shape) {
  constexpr double turn = 2 * std::numbers::pi;
  std::array<double, 3> middle{}, half{};
  for (std::size_t i = 0; i < 3; ++i) {
    middle[i] = (shape.from[i] + shape.to[i]) / 2;
    half[i] = (shape.to[i] - shape.from[i]) / 2;
  }
  const auto q = coordinates_of(*shape.system, shape.axes, middle);
  if (!q) return std::nullopt;
  std::optional<Term> walls;
  for (std::size_t i = 0; i < 3; ++i) {
    const Coordinate& c = (*q)[i];
    if (c.is_angle && 2 * half[i] >= turn * (1 - 1e-12)) continue;  // the whole round: no wall
    // No wall at the axis of a turn: distances are never negative.
    const bool from_axis = shape.system->axes()[shape.axes[i]].kind == AxisKind::distance && shape.from[i] <= 0;
    const Term past = from_axis ? c.q - shape.to[i] : abs(c.q - middle[i]) - half[i];
    const Term wall = c.millimeters * past - seam;  // also where walls run together, at a pole
    walls = walls ? max(*walls, wall) : wall;
  }
  // A box that holds the element: its bounds.
  const Box3 box = box_around(shape);
  const Vec3 extent = 0.5 * (box.max - box.min);
  return intersection_of(Field::from_term(*walls), Field::box(extent).translated(box.min + extent));
}

}  // namespace meso::implicit
