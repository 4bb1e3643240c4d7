// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which cells of a lattice a boundary rule takes whole: those inside a body, or those that meet it. Private.
//
//   const auto taken = select_cells(cell, last, body, {.rule = BoundaryRule::drop_partial}, run, sink);
//   if (taken) lattice_union(cell, taken->set, options, sink);
//
// What is judged is a cell's box, or its body, box by box. Boxes that the boundary does not cross need no geometry; the
// others are clipped, once for all that see the same piece of the body. A clearance is measured for cells near the
// boundary only, some milliseconds each.

#include "lattice/shape_lattice.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/document.hpp"

namespace meso::brep {

struct CellRule {
  BoundaryRule rule = BoundaryRule::drop_partial;  ///< not clip
  InsideTest test = InsideTest::box;
  double clearance = 0;  ///< millimetres; of drop_partial
};

struct CellSelection {
  LatticeSet set;  ///< `inside` owns what it needs
  std::uint64_t kept = 0;
  std::uint64_t crossing = 0;  ///< of these, with the boundary within what was judged
};

/// Of the cells (0, 0, 0) ... `last`. `body`: outward solids in the frame of the cell. Volumes and distances are
/// decided within 1e-6 mm. Empty, with a diagnostic, if something fails or the run is to stop. May throw
/// Standard_Failure.
[[nodiscard]] std::optional<CellSelection> select_cells(const CellShape& cell, const Index3& last,
                                                        const std::vector<TopoDS_Shape>& body, const CellRule& rule,
                                                        const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::brep
