// SPDX-License-Identifier: Apache-2.0
#pragma once
// lattice_body for a unit cell that is any OpenCASCADE solid, and the union of such cells. Private.

#include "lattice/cell_solid.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

/// `cell.primitives` may be empty: then the volume of the template is checked by the boolean's own sums alone.
[[nodiscard]] std::optional<Body> lattice_body(const CellShape& cell, const LatticeSet& set,
                                               const LatticeOptions& options, DiagnosticSink& sink);

/// The regularised union of the cells of the set, whole: with what sticks out of their boxes. Errors as lattice_body.
[[nodiscard]] std::optional<Body> lattice_union(const CellShape& cell, const LatticeSet& set,
                                                const LatticeOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
