// SPDX-License-Identifier: Apache-2.0
#include "bent_part.hpp"

#include <array>

#include "coordinate_inverse.hpp"
#include "meso/implicit/point_function.hpp"
#include "volume_element.hpp"

namespace meso::implicit {

std::optional<Field> bent_part(const eval::CellStream& cells, const eval::PlacedCell& cell, const Field& part,
                               const Reporter& report) {
  if (!cells.unit_cell().clip_to_box.value_or(false)) {
    report(Code::conformal_not_realised, cells.unit_cell().id_in_source, {"a part that is not cut to its box"});
    return std::nullopt;
  }
  const auto box = cells.cell_box(cell, report.sink());
  const auto region = box ? cells.cell_region(cell, report.sink()) : std::nullopt;
  if (!region) return std::nullopt;
  const auto& element = std::get<eval::VolumeElementShape>(region->value);
  std::array<double, 3> middle{};
  for (std::size_t a = 0; a < 3; ++a) middle[a] = (element.from[a] + element.to[a]) / 2;
  const auto q = coordinates_of(*element.system, element.axes, middle);
  const auto walls = q ? volume_element(element) : std::nullopt;
  if (!walls) {
    report(Code::conformal_not_inverted, cells.pattern().id_in_source, {});
    return std::nullopt;
  }
  std::array<Term, 3> source;
  for (std::size_t a = 0; a < 3; ++a) {
    const double edge = box->size[a] / cell.step[a];
    source[a] = edge * (*q)[a].q - (edge * cell.q[a] - box->corner[a]);
  }
  return intersection_of(Field::from_term(taken_from(part.term(), source)), *walls);
}

}  // namespace meso::implicit
