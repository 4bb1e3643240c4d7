// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/lattice_body.hpp"

#include "lattice/assembly.hpp"
#include "lattice/quotient_builder.hpp"
#include "lattice/shape_lattice.hpp"

namespace meso::brep {

std::optional<Body> lattice_body(const CellShape& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  KeptCells cells(set);
  const Reach reach = reach_of(cell);
  if (reach.neighbours.size() > 64) {  // a bit each
    sink.report({.code = Code::geometry_not_repeatable, .args = {"the unit cell reaches too far beyond its box"}});
    return {};
  }
  CellKinds kinds(reach, cells);
  const auto solids = kind_solids(cell, reach, kinds.parts(), {.jobs = 1}, sink);
  if (!solids) return {};
  std::optional<Quotient> quotient = build_quotient(cell, *solids, options, cell.tolerance(), {.jobs = 1}, sink);
  if (!quotient) return {};
  return assemble(std::move(*quotient), std::move(cells), std::move(kinds), sink);
}

std::optional<Body> lattice_body(const LatticeCell& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  const std::optional<CellShape> shape = cell_shape(cell, sink);
  if (!shape) return {};
  return lattice_body(*shape, set, options, sink);
}

}  // namespace meso::brep
