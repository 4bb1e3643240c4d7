// SPDX-License-Identifier: Apache-2.0
#pragma once
// From the quotient and the kept cells to a Body: which faces stand where, and which of them make one shell. Private.

#include <optional>

#include "lattice/kept_cells.hpp"
#include "lattice/quotient.hpp"

namespace meso::brep {

/// The kind of a cell, by which of the neighbours that matter exist in the pattern.
[[nodiscard]] std::uint64_t present_neighbours(const std::vector<Neighbour>& neighbours, const KeptCells& cells,
                                               const Index3& cell);

/// Empty, with GEOMETRY_NOT_REPEATABLE, if some edge would not be used exactly twice by every sheet of surface that
/// meets there, or the shells do not enclose the volume that the cells hold.
[[nodiscard]] std::optional<Body> assemble(Quotient quotient, KeptCells cells, DiagnosticSink& sink);

}  // namespace meso::brep
