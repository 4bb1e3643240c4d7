// SPDX-License-Identifier: Apache-2.0
#include "volume_element.hpp"

#include <numbers>

#include "coordinate_inverse.hpp"
#include "meso/eval/bounds.hpp"
#include "meso/implicit/document_field.hpp"

namespace meso::implicit {

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
  const Box3 box = *eval::bounds({shape});
  const Vec3 extent = 0.5 * (box.max - box.min);
  return intersection_of(Field::from_term(*walls), Field::box(extent).translated(box.min + extent));
}

}  // namespace meso::implicit
