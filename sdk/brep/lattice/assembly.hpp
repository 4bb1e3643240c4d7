// SPDX-License-Identifier: Apache-2.0
#pragma once
// From the quotient and the kept cells to a Body: which faces stand where, and which of them make one shell. Private.

#include <functional>
#include <map>
#include <optional>

#include "lattice/kept_cells.hpp"
#include "lattice/quotient.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

/// The kind of box each cell has: at first by which of the cells that matter to it exist in the pattern.
class CellKinds {
 public:
  /// Nothing of the lattice is in boxes that are not asked for by `holds`.
  CellKinds(const Reach& reach, const KeptCells& cells, const std::function<bool(Index3)>& holds = {});
  /// Where `parts_of` tells what each box holds.
  CellKinds(const KeptCells& cells, const std::function<std::vector<std::uint32_t>(Index3)>& parts_of);
  /// The parts of each of these kinds; kind 0 has all, some may have none.
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& parts() const { return parts_; }
  [[nodiscard]] std::uint32_t of(const Index3& cell, const KeptCells& cells) const {
    return kinds_[cells.number(cell)];
  }
  /// Of the cell with that number, from now on.
  void set(std::uint32_t number, std::uint32_t kind) { kinds_[number] = kind; }

 private:
  std::vector<std::vector<std::uint32_t>> parts_;
  std::vector<std::uint32_t> kinds_;  ///< by the numbers of the cells
};

/// Empty, with GEOMETRY_NOT_REPEATABLE, if some edge would not be used exactly twice by every sheet of surface that
/// meets there, or the shells do not enclose the volume that the cells hold. LIMIT_TIME or CANCELLED if the run is to
/// stop.
[[nodiscard]] std::optional<Body> assemble(Quotient quotient, KeptCells cells, CellKinds kinds, const RunOptions& run,
                                           DiagnosticSink& sink);

/// What the boxes of a lattice take until it is a body, about; false, and LIMIT_MEMORY, if that is over the budget.
[[nodiscard]] bool fit_in_memory(std::uint64_t boxes, const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::brep
