// SPDX-License-Identifier: Apache-2.0
#include "pattern_field.hpp"

#include <algorithm>

#include "cell_primitives.hpp"
#include "implicit_pattern.hpp"

namespace meso::implicit {
namespace {

/// Columns that are missing, because an index takes one value, filled up; nothing if they are not independent.
std::optional<Repetition> repetition_of(const eval::CellStream::Lattice& lattice) {
  Vec3 columns[3] = {lattice.lattice.column(0), lattice.lattice.column(1), lattice.lattice.column(2)};
  for (std::size_t k = 0; k < 3; ++k) {
    if (lattice.count[k] > 1) continue;
    const Vec3 a = columns[(k + 1) % 3], b = columns[(k + 2) % 3];
    Vec3 free = cross(a, b);
    if (norm(free) == 0) {
      const Vec3 along = norm(a) > 0 ? a : b;
      free = norm(along) == 0 ? Vec3{1, 0, 0}
                              : cross(along, std::abs(along.x) <= 0.5 * norm(along) ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    }
    columns[k] = free / norm(free);
  }
  const Mat3 steps = Mat3::from_columns(columns[0], columns[1], columns[2]);
  if (std::abs(determinant(steps)) < 1e-9 * norm(columns[0]) * norm(columns[1]) * norm(columns[2])) return std::nullopt;
  return Repetition{steps, lattice.count};
}

/// So far away from a primitive values may matter: as far as it is thick.
double reach_of(const Primitive& p) {
  if (p.is_capsule()) return 2 * p.capsule.radius;
  const Vec3 size = p.box.max - p.box.min;
  return std::min({size.x, size.y, size.z}) / 2;
}

/// Their values are distances up to `reach` at least.
Field placed_cells(std::vector<Primitive> primitives, const std::optional<Repetition>& repetition, double reach = 0) {
  for (const Primitive& p : primitives) reach = std::max(reach, reach_of(p));
  if (primitives.empty()) return nothing();
  return Field::external(std::make_shared<const PlacedCells>(PrimitiveIndex(std::move(primitives), repetition), reach));
}

bool is_implicit(const eval::CellStream& cells) { return std::holds_alternative<ImplicitBody>(cells.unit_cell().body); }

}  // namespace

std::optional<Field> field_of_cell(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                   const eval::PlacedCell& cell, ShapeFields& shapes, const Reporter& report) {
  if (is_implicit(cells)) return implicit_cell(evaluation, cells, cell, report);
  std::vector<Primitive> primitives;
  if (!CellPrimitives(evaluation, cells, shapes, report).add(cell, primitives)) return std::nullopt;
  return placed_cells(std::move(primitives), {});
}

std::optional<PatternField> field_of_pattern(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                             const KeepCell& keep, ShapeFields& shapes, double reach,
                                             const RunOptions& run, const Reporter& report) {
  if (is_implicit(cells)) return implicit_pattern(evaluation, cells, keep, run, report);
  CellPrimitives bodies(evaluation, cells, shapes, report);
  PatternField result{nothing()};
  result.placed = cells.size();
  const auto lattice = keep ? std::nullopt : cells.lattice();
  const auto repetition = lattice ? repetition_of(*lattice) : std::nullopt;
  std::vector<Primitive> primitives;
  bool good = true;
  const bool visited = cells.visit(
      0, repetition ? 1 : cells.size(),
      [&](const eval::PlacedCell& cell) {
        if (result.kept % 1024 == 0 && run.should_stop()) {
          report.sink().report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
          return good = false;
        }
        if (primitives.size() * sizeof(Primitive) > run.max_memory_bytes) {
          report(Code::limit_memory, cells.pattern().id_in_source,
                 {std::to_string(run.max_memory_bytes >> 20) + " MiB"});
          return good = false;
        }
        const auto kept = keep ? keep(cell) : true;
        if (!kept || (*kept && !bodies.add(cell, primitives))) return good = false;
        result.kept += *kept ? 1 : 0;
        return true;
      },
      report.sink());
  if (!visited || !good) return std::nullopt;
  if (repetition) result.kept = cells.size();
  result.smallest_feature_mm = bodies.smallest_feature_mm();
  result.field = placed_cells(std::move(primitives), repetition, reach);
  return result;
}

}  // namespace meso::implicit
