// SPDX-License-Identifier: Apache-2.0
#include "lattice/clipped_lattice.hpp"

#include <deque>
#include <map>

#include "boolean.hpp"
#include "lattice/assembly.hpp"
#include "lattice/cell_clipper.hpp"
#include "lattice/cells_of_boxes.hpp"
#include "lattice/clip_signature.hpp"
#include "lattice/parallel.hpp"
#include "lattice/quotient_builder.hpp"
#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

/// One boolean: a kind of box and a cell that stands for all that see the same.
struct ClipTask {
  std::uint32_t kind = 0;
  Index3 cell{};
  ClippedCell result;
};

/// The boxes that both the body and anything of the pattern can reach.
CellGrid grid_for(const CellShape& cell, const Reach& reach, const Index3& last,
                  const std::vector<TopoDS_Shape>& body) {
  CellGrid grid{.first = cell.box, .min = {}, .max = last, .tolerance = cell.tolerance()};
  for (const Reach::Neighbour& neighbour : reach.rim)
    for (std::size_t i = 0; i < 3; ++i) {
      grid.min[i] = std::min(grid.min[i], -neighbour.shift[i]);
      grid.max[i] = std::max(grid.max[i], last[i] - neighbour.shift[i]);
    }
  Box3 all;
  for (const TopoDS_Shape& solid : body) {
    const Box3 box = box_of(solid);
    all.extend(box.min);
    all.extend(box.max);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto box_at = [&](double p) { return std::floor((p - cell.box.min[i]) / cell.size()[i]); };
    grid.min[i] = static_cast<std::int32_t>(std::max<double>(grid.min[i], box_at(all.min[i] - grid.tolerance)));
    grid.max[i] = static_cast<std::int32_t>(std::min<double>(grid.max[i], box_at(all.max[i] + grid.tolerance)));
  }
  return grid;
}

/// Numbers of kinds, sorted by the pieces of the body that the cells see, in the order of the cells.
class ClipPlan {
 public:
  ClipPlan(const BodySurface& surface, const KeptCells& cells, const CellKinds& kinds, const CellGrid& grid,
           bool reuse) {
    const ClipSignatures signatures(surface.body(), grid);
    std::map<ClipSignatures::Signature, std::uint32_t> known;
    task_of_.assign(cells.count(), KeptCells::none);
    for (std::uint32_t n = 0; n < cells.count(); ++n) {
      const Index3& cell = cells.cell(n);
      if (surface.place(cell) != BoxPlace::crossing) continue;
      ClipSignatures::Signature key = signatures.of(cell, surface.faces(cell));
      key.push_back(kinds.of(cell, cells));
      if (!reuse) key.push_back(n);
      const auto [it, fresh] = known.emplace(std::move(key), static_cast<std::uint32_t>(tasks.size()));
      if (fresh) tasks.push_back({.kind = kinds.of(cell, cells), .cell = cell, .result = {}});
      task_of_[n] = it->second;
    }
  }
  /// `KeptCells::none` for a whole cell.
  [[nodiscard]] std::uint32_t task_of(std::uint32_t cell) const { return task_of_[cell]; }

  std::vector<ClipTask> tasks;

 private:
  std::vector<std::uint32_t> task_of_;
};

/// All tasks, by as many threads as the run allows; which thread does which does not show in the results.
void clip_all(std::vector<ClipTask>& tasks, const std::vector<TopoDS_Shape>& solids, const BodySurface& surface,
              const CellGrid& grid, const RunOptions& run) {
  std::deque<CellClipper> clippers;  // they cannot be moved
  for (std::size_t i = 0; i < workers_for(tasks.size(), run); ++i) clippers.emplace_back(solids, surface, grid, run);
  (void)in_parallel(tasks.size(), run, [&](std::size_t worker, std::size_t i) {
    ClipTask& task = tasks[i];
    task.result = clippers[worker].clip(task.kind, task.cell, surface.faces(task.cell));
    return task.result.fault.empty();
  });
}

/// What it took, as numbers and, where it was not the usual, as diagnostics.
ClipCounts counts_of(const std::vector<ClipTask>& tasks, Vec3 size, DiagnosticSink& sink) {
  ClipCounts counts{.distinct = tasks.size()};
  for (const ClipTask& task : tasks) {
    counts.attempts.resize(std::max(counts.attempts.size(), task.result.attempts));
    ++counts.attempts[task.result.attempts - 1];
    counts.edge_tolerance = std::max(counts.edge_tolerance, task.result.edge_tolerance);
  }
  std::string ways;
  std::uint64_t again = 0;
  for (std::size_t n = 1; n < counts.attempts.size(); ++n) {
    if (counts.attempts[n] == 0) continue;
    again += counts.attempts[n];
    ways += (ways.empty() ? "" : ", ") + std::to_string(counts.attempts[n]) + " took " + std::to_string(n + 1);
  }
  if (again > 0)
    sink.report(
        {.code = Code::geometry_retried, .args = {std::to_string(again), std::to_string(counts.distinct), ways}});
  const double rough = rough_edge * std::min({size.x, size.y, size.z});
  if (counts.edge_tolerance > rough)
    sink.report(
        {.code = Code::geometry_edge_tolerance, .args = {format_number(counts.edge_tolerance), format_number(rough)}});
  return counts;
}

}  // namespace

std::optional<ClippedLattice> clipped_lattice_body(const CellShape& cell, const Index3& last,
                                                   const std::vector<TopoDS_Shape>& body, const ClipOptions& options,
                                                   const RunOptions& run, DiagnosticSink& sink) {
  const auto fault = [&](std::string what) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {std::move(what)}});
    return std::nullopt;
  };
  const auto stopped = [&] {
    sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    return std::nullopt;
  };
  const Reach reach = reach_of(cell);
  if (std::max(reach.neighbours.size(), reach.rim.size()) > 64)
    return fault("the unit cell reaches too far beyond its box");
  const CellGrid grid = grid_for(cell, reach, last, body);
  if (grid.count() == 0) return ClippedLattice{};
  if (grid.count() > run.max_cells) return fault("the body meets too many boxes");
  if (!fit_in_memory(grid.count(), run, sink)) return {};
  const BodySurface surface(body, grid);
  KeptCells cells({.min = {}, .max = last, .inside = {}}, grid.min, grid.max,
                  [&](const Index3& index) { return surface.place(index) != BoxPlace::outside; });
  if (run.should_stop()) return stopped();
  CellKinds kinds(reach, cells);
  auto solids = kind_solids(cell, reach, kinds.parts(), run, sink);
  if (run.should_stop()) return stopped();
  if (!solids) return {};
  ClipPlan plan(surface, cells, kinds, grid, options.reuse);
  clip_all(plan.tasks, *solids, surface, grid, run);
  if (run.should_stop()) return stopped();
  std::vector<std::uint32_t> kind_of_task;
  ClippedLattice out;
  for (ClipTask& task : plan.tasks) {
    if (!task.result.fault.empty()) return fault(task.result.fault);
    if (task.result.left == ClippedCell::Left::all) {
      kind_of_task.push_back(task.kind);
      continue;
    }
    kind_of_task.push_back(static_cast<std::uint32_t>(solids->size()));
    solids->push_back(task.result.solid);
  }
  CellsOfBoxes kept(last, options.block), crossing(last, options.block);
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const std::uint32_t task = plan.task_of(n);
    if (task != KeptCells::none) kinds.set(n, kind_of_task[task]);
    const TopoDS_Shape& solid = (*solids)[kinds.of(cells.cell(n), cells)];
    if (!solid.IsNull()) kept.add(cells.cell(n));
    if (task != KeptCells::none && plan.tasks[task].result.left == ClippedCell::Left::part) crossing.add(cells.cell(n));
  }
  out.kept = kept.count();
  out.crossing = crossing.count();
  if (out.kept == 0) return out;
  auto quotient = build_quotient(cell, *solids, {.mesh = options.mesh, .run = {}}, 10 * cell.tolerance(), run, sink);
  if (run.should_stop()) return stopped();
  if (!quotient) return {};
  auto made = assemble(std::move(*quotient), std::move(cells), std::move(kinds), run, sink);
  if (!made) return {};
  out.body = std::move(*made);
  out.clip = counts_of(plan.tasks, grid.size(), sink);
  return out;
}

}  // namespace meso::brep
