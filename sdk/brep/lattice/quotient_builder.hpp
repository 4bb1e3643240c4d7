// SPDX-License-Identifier: Apache-2.0
#pragma once
// Builds the quotient of a lattice from the solid in each kind of box. Private.

#include <optional>

#include "lattice/quotient.hpp"

namespace meso::brep {

/// `present` lists the kinds wanted, the one with every neighbour first. Empty, with GEOMETRY_NOT_REPEATABLE, if a
/// solid cannot be made or does not close upon itself.
[[nodiscard]] std::optional<Quotient> build_quotient(const CellShape& cell, std::vector<Neighbour> neighbours,
                                                     const std::vector<std::uint64_t>& present,
                                                     const LatticeOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
