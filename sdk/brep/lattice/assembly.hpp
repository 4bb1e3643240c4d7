// SPDX-License-Identifier: Apache-2.0
#pragma once
// From the quotient and the kept cells to a Body: which faces stand where, and which of them make one shell. Private.

#include <map>
#include <optional>

#include "lattice/kept_cells.hpp"
#include "lattice/quotient.hpp"

namespace meso::brep {

/// The kind of box each cell has, by which of the neighbours that matter exist in the pattern.
class CellKinds {
 public:
  CellKinds(const Reach& reach, const KeptCells& cells);
  /// The parts of each kind; kind 0 has all.
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& parts() const { return parts_; }
  [[nodiscard]] std::uint32_t of(const Index3& cell, const KeptCells& cells) const {
    return parts_.size() == 1 ? 0 : kinds_.at(present(cell, cells));
  }

 private:
  [[nodiscard]] std::uint64_t present(const Index3& cell, const KeptCells& cells) const;

  std::vector<Index3> shifts_;  // of the neighbours
  std::vector<std::vector<std::uint32_t>> parts_;
  std::map<std::uint64_t, std::uint32_t> kinds_;
};

/// Empty, with GEOMETRY_NOT_REPEATABLE, if some edge would not be used exactly twice by every sheet of surface that
/// meets there, or the shells do not enclose the volume that the cells hold.
[[nodiscard]] std::optional<Body> assemble(Quotient quotient, KeptCells cells, CellKinds kinds, DiagnosticSink& sink);

}  // namespace meso::brep
