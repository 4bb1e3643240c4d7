// SPDX-License-Identifier: Apache-2.0
// Patterns whose cells are translates of one lattice.
#include <algorithm>

#include "cell_stream_impl.hpp"

namespace meso::eval {
namespace {

bool is_constant(const std::optional<BoundExpression>& e) { return !e || e->level == constant_level; }

bool is_regular(const LoopProgram& loop) {
  return loop.places.empty() && !loop.scatter && !loop.cumulative && !loop.position && is_constant(loop.count) &&
         is_constant(loop.start) && is_constant(loop.spacing) &&
         (!loop.direction || std::all_of(loop.direction->begin(), loop.direction->end(),
                                         [](const BoundExpression& e) { return e.level == constant_level; }));
}

bool stands_regularly(const PatternProgram& program) {
  return program.mapping == CellMapping::rigid && !program.drops_cells && program.turn_level == constant_level &&
         program.loops.size() <= 3 &&
         std::ranges::all_of(program.loops, [](const LoopProgram& loop) { return is_regular(loop); }) &&
         std::ranges::all_of(program.statements,
                             [](const Statement& s) { return !s.moves() || s.level == constant_level; });
}

bool has_equal_cells(const PatternProgram& program) {
  return program.node_statements.empty() &&
         std::ranges::all_of(program.statements, [](const Statement& s) { return s.level == constant_level; });
}

}  // namespace

std::optional<CellStream::Lattice> CellStream::lattice() const {
  auto lattice = has_equal_cells(*impl_->program) ? lattice_of_places() : std::nullopt;
  // Cells that coincide are each a cell, and counted.
  for (std::size_t k = 0; lattice && k < 3; ++k)
    if (lattice->count[k] > 1 && lattice->lattice.column(k) == Vec3{}) lattice.reset();
  return lattice;
}

std::optional<CellStream::Lattice> CellStream::lattice_of_places() const {
  if (size() == 0 || !stands_regularly(*impl_->program)) return std::nullopt;
  Lattice result;
  const std::vector<std::int64_t> counts = extents();
  std::copy(counts.begin(), counts.end(), result.count.begin());

  DiagnosticSink failed;
  Vec3 columns[3];
  std::uint64_t ordinal_step = 1;
  Vec3 origin;
  const auto position_of = [&](std::uint64_t ordinal, Affine& placed) {
    return visit(
        ordinal, ordinal + 1, [&](const PlacedCell& c) { return placed = c.world_from_cell, true; }, failed);
  };
  if (!position_of(0, result.world_from_first)) return std::nullopt;
  origin = result.world_from_first.translation;
  // The longest way along each index gives the step to the last digit that the cells themselves have.
  for (std::size_t k = counts.size(); k-- > 0;) {
    const auto steps = static_cast<std::uint64_t>(counts[k]) - 1;
    Affine last;
    if (steps > 0) {
      if (!position_of(steps * ordinal_step, last)) return std::nullopt;
      columns[k] = (last.translation - origin) / static_cast<double>(steps);
    }
    ordinal_step *= static_cast<std::uint64_t>(counts[k]);
  }
  result.lattice = Mat3::from_columns(columns[0], columns[1], columns[2]);
  return result;
}

}  // namespace meso::eval
