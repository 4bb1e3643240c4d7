// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/lattice_body.hpp"

#include <algorithm>

#include "lattice/assembly.hpp"
#include "lattice/quotient_builder.hpp"
#include "lattice/shape_lattice.hpp"
#include "meso/brep/instance_map.hpp"

namespace meso::brep {

namespace {

/// From the boxes that hold anything to the body.
std::optional<Body> made_of(const CellShape& cell, const Reach& reach, KeptCells cells, const LatticeOptions& options,
                            DiagnosticSink& sink) {
  const auto stopped = [&] {
    if (!options.run.should_stop()) return false;
    sink.report({.code = options.run.out_of_time() ? Code::limit_time : Code::cancelled});
    return true;
  };
  if (std::max(reach.neighbours.size(), reach.rim.size()) > 64) {  // a bit each
    sink.report({.code = Code::geometry_not_repeatable, .args = {"the unit cell reaches too far beyond its box"}});
    return {};
  }
  if (stopped()) return {};
  CellKinds kinds(reach, cells);
  const auto solids = kind_solids(cell, reach, kinds.parts(), options.run, sink);
  if (stopped() || !solids) return {};
  std::optional<Quotient> quotient = build_quotient(cell, *solids, options, cell.tolerance(), options.run, sink);
  if (stopped() || !quotient) return {};
  return assemble(std::move(*quotient), std::move(cells), std::move(kinds), options.run, sink);
}

}  // namespace

std::optional<Body> lattice_body(const CellShape& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  return made_of(cell, reach_of(cell), KeptCells(set), options, sink);
}

std::optional<Body> lattice_union(const CellShape& cell, const LatticeSet& set, const LatticeOptions& options,
                                  DiagnosticSink& sink) {
  const Reach reach = reach_of(cell);
  const auto has = [&](const Index3& index) {
    for (std::size_t i = 0; i < 3; ++i)
      if (index[i] < set.min[i] || index[i] > set.max[i]) return false;
    return set.inside(index);
  };
  Index3 min = set.min, max = set.max;
  for (const Reach::Neighbour& neighbour : reach.rim)
    for (std::size_t i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], set.min[i] - neighbour.shift[i]);
      max[i] = std::max(max[i], set.max[i] - neighbour.shift[i]);
    }
  std::uint64_t boxes = 1;
  for (std::size_t i = 0; i < 3; ++i) boxes *= static_cast<std::uint64_t>(max[i] - min[i] + 1);
  if (!fit_in_memory(boxes, options.run, sink)) return {};
  const auto holds_something = [&](const Index3& box) {
    return has(box) || std::any_of(reach.rim.begin(), reach.rim.end(),
                                   [&](const Reach::Neighbour& neighbour) { return has(box + neighbour.shift); });
  };
  return made_of(cell, reach, KeptCells(set, min, max, holds_something), options, sink);
}

std::optional<Body> lattice_body(const LatticeCell& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  const std::optional<CellShape> shape = cell_shape(cell, sink);
  if (!shape) return {};
  return lattice_body(*shape, set, options, sink);
}

}  // namespace meso::brep
