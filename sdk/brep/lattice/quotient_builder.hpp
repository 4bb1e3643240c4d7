// SPDX-License-Identifier: Apache-2.0
#pragma once
// Builds the quotient of a lattice from the solid in each kind of box. Private.

#include <optional>

#include "lattice/quotient.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

/// What each kind of box holds: `kinds` lists the parts, the one with all parts first. Edges of opposite walls end
/// alike. A kind without parts is a null shape. Empty, with GEOMETRY_NOT_REPEATABLE, if a solid cannot be made; without
/// that, if more kinds of cells that vary take booleans than `budget` has.
[[nodiscard]] std::optional<std::vector<TopoDS_Shape>> kind_solids(const CellShape& cell, const Reach& reach,
                                                                   const std::vector<std::vector<std::uint32_t>>& kinds,
                                                                   const RunOptions& run, DiagnosticSink& sink,
                                                                   FusedBudget* budget = nullptr);

/// Points of two solids closer than `tolerance` are one. Empty, with GEOMETRY_NOT_REPEATABLE, if a solid is not a
/// manifold or the run is to stop.
[[nodiscard]] std::optional<Quotient> build_quotient(const CellShape& cell, const std::vector<TopoDS_Shape>& solids,
                                                     const LatticeOptions& options, double tolerance,
                                                     const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::brep
