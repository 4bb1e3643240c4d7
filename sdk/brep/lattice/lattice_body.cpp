// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/lattice_body.hpp"

#include <algorithm>

#include "lattice/assembly.hpp"
#include "lattice/circles_apart.hpp"
#include "lattice/quotient_builder.hpp"
#include "lattice/shape_lattice.hpp"
#include "lattice/united_cells.hpp"
#include "lattice/varied_cells.hpp"
#include "meso/brep/instance_map.hpp"

namespace meso::brep {

namespace {

/// From the boxes that hold anything to the body.
std::optional<Body> made_of(const CellShape& cell, KeptCells cells, const LatticeOptions& options,
                            DiagnosticSink& sink) {
  const auto stopped = [&] {
    if (!options.run.should_stop()) return false;
    sink.report({.code = options.run.out_of_time() ? Code::limit_time : Code::cancelled});
    return true;
  };
  const auto fault = [&](const char* what) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {what}});
    return std::nullopt;
  };
  const Reach reach = reach_of(cell);
  if (std::max(reach.neighbours.size(), reach.rim.size()) > 64)  // a bit each
    return fault("the unit cell reaches too far beyond its box");
  if (stopped()) return {};
  CellKinds kinds(reach, cells);
  auto solids = kind_solids(cell, reach, kinds.parts(), options.run, sink);
  if (stopped() || !solids) return {};
  const CellGrid grid{.first = cell.box, .min = {}, .max = {}, .tolerance = cell.tolerance()};
  if (cell.varied && !align_edges(grid, cells, 0, kinds, *solids))
    return fault("the walls of boxes cannot be divided alike");
  const double tolerance = (cell.varied ? 10 : 1) * cell.tolerance();
  std::optional<Quotient> quotient = build_quotient(cell, *solids, options, tolerance, options.run, sink);
  if (stopped() || !quotient) return {};
  return assemble(std::move(*quotient), std::move(cells), std::move(kinds), options.run, sink);
}

/// Where OpenCASCADE does not find the union of a cell's balls and struts, boxes are put together without it; where
/// that fails, too, with struts that do not touch.
std::optional<Body> made_in_some_way(const CellShape& cell, const KeptCells& cells, const LatticeOptions& options,
                                     DiagnosticSink& sink) {
  DiagnosticSink told;
  auto made = made_of(cell, cells, options, told);
  const auto is_over = [&] { return made || told.has_errors() || options.run.should_stop(); };
  const auto again = [&](const std::optional<CellShape>& other) {
    if (!other || is_over()) return;
    DiagnosticSink here;
    made = made_of(*other, cells, options, here);
    if (made || here.has_errors()) told = std::move(here);
  };
  if (!is_over()) again(as_varied(cell));
  if (!is_over()) {
    const auto apart = with_circles_apart(cell);
    if (apart) again(as_varied(*apart));
    if (made) sink.report({.code = Code::geometry_balls_enlarged});
  }
  for (const Diagnostic& d : told.diagnostics()) sink.report(d);
  return made;
}

}  // namespace

std::optional<Body> lattice_body(const CellShape& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  return made_in_some_way(cell, KeptCells(set), options, sink);
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
  return made_in_some_way(cell, KeptCells(set, min, max, holds_something), options, sink);
}

std::optional<Body> lattice_body(const LatticeCell& cell, const LatticeSet& set, const LatticeOptions& options,
                                 DiagnosticSink& sink) {
  const std::optional<CellShape> shape = cell_shape(cell, sink);
  if (!shape) return {};
  return lattice_body(*shape, set, options, sink);
}

}  // namespace meso::brep
