// SPDX-License-Identifier: Apache-2.0
#pragma once
// Builds the quotient of a lattice from the solid in each kind of box. Private.

#include <optional>

#include "lattice/quotient.hpp"

namespace meso::brep {

/// `kinds` lists the parts of each kind of box, the one with all parts first. Empty, with GEOMETRY_NOT_REPEATABLE, if a
/// solid cannot be made or is not a manifold.
[[nodiscard]] std::optional<Quotient> build_quotient(const CellShape& cell, const Reach& reach,
                                                     const std::vector<std::vector<std::uint32_t>>& kinds,
                                                     const LatticeOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
