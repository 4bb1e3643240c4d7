// SPDX-License-Identifier: Apache-2.0
#pragma once
// All cells of a pattern as one field. Private.
//
//   cells                                          become
//   beams                                          capsules and cones in PlacedCells
//   implicit, repeating over boxes side by side    one term of the whole, cut to the boxes
//   parts that a conformal mapping bends           a field for each cell in PlacedCells
//   anything else                                  fields in PlacedCells, one for each different cell
//   translates of one lattice                      one period, counted

#include <functional>

#include "implicit_cell.hpp"
#include "placed_cells.hpp"
#include "shape_field.hpp"

namespace meso::implicit {

struct PatternField {
  Field field;
  double smallest_feature_mm = HUGE_VAL;
  double density_spacing_mm = HUGE_VAL;
  std::uint64_t placed = 0, kept = 0;
};

/// Whether a cell takes part; nothing if something was reported.
using KeepCell = std::function<std::optional<bool>(const eval::PlacedCell&)>;

/// A cell alone, in the world, for rules that ask for bodies.
[[nodiscard]] std::optional<Field> field_of_cell(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                                 const eval::PlacedCell& cell, ShapeFields& shapes,
                                                 const Reporter& report);

/// `keep`: empty for all. `reach`: values are good that far from the cells, at least. Nothing if something was
/// reported.
[[nodiscard]] std::optional<PatternField> field_of_pattern(const eval::Evaluation& evaluation,
                                                           const eval::CellStream& cells, const KeepCell& keep,
                                                           ShapeFields& shapes, double reach, const RunOptions& run,
                                                           const Reporter& report);

}  // namespace meso::implicit
