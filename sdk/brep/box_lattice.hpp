// SPDX-License-Identifier: Apache-2.0
#pragma once
// Patterns whose cell boxes stand side by side, or whose beams do. A cell whose part is itself such a pattern, and
// fills the cell's box, is that pattern continued: hierarchy of any depth is then one lattice of the smallest boxes.
// Private.

#include <array>
#include <optional>

#include "meso/brep/body.hpp"
#include "meso/eval/evaluation.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Box (i, j, k), counted along the box axes, is the first one moved by i dx, j dy, k dz.
struct BoxLattice {
  eval::BoxShape box;
  Affine world_from_cell;  ///< of box (0, 0, 0), rigid
  Index3 count{1, 1, 1};
  Index3 block{1, 1, 1};         ///< boxes that one cell of the pattern has along each axis
  eval::Shape shape;             ///< of what belongs to one box, in its own coordinates
  bool cut = false;              ///< to the box
  bool is_cut_by_cells = false;  ///< and that only where a cell of the pattern ends
  bool is_fitted = false;        ///< boxes are as long as the steps, which are not the edges of the cells' boxes
  bool varies = false;           ///< struts differ from cell to cell; `shape` is the first's

  [[nodiscard]] bool is_refined() const { return block != Index3{1, 1, 1}; }
};

/// `may_refine`: boxes may be smaller than those of the pattern's cells; `may_vary`: see BoxLattice. Nothing where
/// cells do not stand so. Errors of evaluation are reported.
[[nodiscard]] std::optional<BoxLattice> box_lattice(const eval::CellStream& cells, bool may_refine, bool may_vary,
                                                    const SolidContext& context);

/// Box and shape of the first cell that is kept, where it has a box.
struct FirstCell {
  eval::BoxShape box;
  eval::Shape shape;
};
[[nodiscard]] std::optional<FirstCell> first_cell(const eval::CellStream& cells, DiagnosticSink& sink);

}  // namespace meso::brep
