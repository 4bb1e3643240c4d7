// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/lattice_body.hpp"

#include <algorithm>

#include "lattice/assembly.hpp"
#include "lattice/quotient_builder.hpp"
#include "lattice/shape_lattice.hpp"

namespace meso::brep {

std::optional<Body> lattice_body(const CellShape& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  KeptCells cells(set);
  std::vector<Neighbour> neighbours = reaching_neighbours(cell);
  if (neighbours.size() > 64) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {"the unit cell reaches too far beyond its box"}});
    return {};
  }
  const std::uint64_t all = neighbours.size() == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << neighbours.size()) - 1;
  std::vector<std::uint64_t> present{all};  // first: the natural faces are those of the inner cells
  if (!neighbours.empty())
    for (std::uint32_t n = 0; n < cells.count(); ++n) {
      const std::uint64_t mask = present_neighbours(neighbours, cells, cells.cell(n));
      if (std::find(present.begin(), present.end(), mask) == present.end()) present.push_back(mask);
    }
  std::optional<Quotient> quotient = build_quotient(cell, std::move(neighbours), present, options, sink);
  if (!quotient) return {};
  return assemble(std::move(*quotient), std::move(cells), sink);
}

std::optional<Body> lattice_body(const LatticeCell& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  const std::optional<CellShape> shape = cell_shape(cell, sink);
  if (!shape) return {};
  return lattice_body(*shape, set, options, sink);
}

}  // namespace meso::brep
