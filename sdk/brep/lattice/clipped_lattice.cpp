// SPDX-License-Identifier: Apache-2.0
#include "lattice/clipped_lattice.hpp"

#include <algorithm>
#include <deque>
#include <map>

#include "boolean.hpp"
#include "lattice/assembly.hpp"
#include "lattice/cell_clipper.hpp"
#include "lattice/cells_of_boxes.hpp"
#include "lattice/clip_signature.hpp"
#include "lattice/parallel.hpp"
#include "lattice/quotient_builder.hpp"
#include "lattice/united_cells.hpp"
#include "lattice/varied_cells.hpp"
#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

/// One boolean: a kind of box and a cell that stands for all that see the same.
struct ClipTask {
  std::uint32_t kind = 0;
  Index3 cell{};
  ClippedCell result;
};

Box3 box_of_all(const std::vector<TopoDS_Shape>& solids) {
  Box3 all;
  for (const TopoDS_Shape& solid : solids) {
    const Box3 box = box_of(solid);
    all.extend(box.min);
    all.extend(box.max);
  }
  return all;
}

/// The boxes that both the body, if there is one, and anything of the pattern can reach.
CellGrid grid_for(const CellShape& cell, const Reach& reach, const Index3& last,
                  const std::vector<TopoDS_Shape>& body) {
  CellGrid grid{.first = cell.box, .min = {}, .max = last, .tolerance = cell.tolerance()};
  for (const Reach::Neighbour& neighbour : reach.rim)
    for (std::size_t i = 0; i < 3; ++i) {
      grid.min[i] = std::min(grid.min[i], -neighbour.shift[i]);
      grid.max[i] = std::max(grid.max[i], last[i] - neighbour.shift[i]);
    }
  if (body.empty()) return grid;
  const Box3 all = box_of_all(body);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto box_at = [&](double p) { return std::floor((p - cell.box.min[i]) / cell.size()[i]); };
    grid.min[i] = static_cast<std::int32_t>(std::max<double>(grid.min[i], box_at(all.min[i] - grid.tolerance)));
    grid.max[i] = static_cast<std::int32_t>(std::min<double>(grid.max[i], box_at(all.max[i] + grid.tolerance)));
  }
  return grid;
}

/// The boxes of `grid` and all that the added body is in.
CellGrid grown_for(const CellGrid& grid, const std::vector<TopoDS_Shape>& added) {
  if (added.empty()) return grid;
  CellGrid out = grid;
  const Box3 all = box_of_all(added);
  const bool none = grid.count() == 0;
  const Vec3 size = grid.size();
  for (std::size_t i = 0; i < 3; ++i) {
    // Boxes of shapes are a little larger than the shapes: one that a side only touches is not needed, and does no
    // harm.
    const double low = std::floor((all.min[i] - grid.first.min[i]) / size[i] + 1e-6);
    const double high = std::ceil((all.max[i] - grid.first.min[i]) / size[i] - 1e-6) - 1;
    constexpr double most = 1e9;
    out.min[i] = static_cast<std::int32_t>(std::clamp(none ? low : std::fmin(low, grid.min[i]), -most, most));
    out.max[i] = static_cast<std::int32_t>(std::clamp(none ? high : std::fmax(high, grid.max[i]), -most, most));
  }
  return out;
}

/// Numbers of kinds, sorted by the pieces of the body that the cells see, in the order of the cells.
class ClipPlan {
 public:
  template <typename InBody>
  ClipPlan(const BodySurface& surface, const KeptCells& cells, const CellKinds& kinds, const CellGrid& grid, bool reuse,
           const InBody& in_body) {
    const ClipSignatures signatures(surface.body(), grid);
    std::map<ClipSignatures::Signature, std::uint32_t> known;
    task_of_.assign(cells.count(), KeptCells::none);
    for (std::uint32_t n = 0; n < cells.count(); ++n) {
      const Index3& cell = cells.cell(n);
      if (surface.place(cell) != BoxPlace::crossing || !in_body(cell)) continue;
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
void clip_all(std::vector<ClipTask>& tasks, const std::vector<TopoDS_Shape>& solids,
              const CellClipper::Otherwise& otherwise, const BodySurface& surface, const CellGrid& grid,
              CellClipper::Ways ways, const RunOptions& run) {
  std::deque<CellClipper> clippers;  // they cannot be moved
  for (std::size_t i = 0; i < workers_for(tasks.size(), run); ++i)
    clippers.emplace_back(solids, otherwise, surface, grid, run);
  (void)in_parallel(tasks.size(), run, [&](std::size_t worker, std::size_t i) {
    ClipTask& task = tasks[i];
    task.result = clippers[worker].clip(task.kind, task.cell, surface.faces(task.cell), ways);
    return task.result.fault.empty();
  });
}

/// What it took, as numbers and, where it was not the usual, as diagnostics.
ClipCounts counts_of(const std::vector<ClippedCell>& results, Vec3 size, DiagnosticSink& sink) {
  ClipCounts counts{.distinct = results.size()};
  for (const ClippedCell& result : results) {
    counts.attempts.resize(std::max(counts.attempts.size(), result.attempts));
    ++counts.attempts[result.attempts - 1];
    counts.edge_tolerance = std::max(counts.edge_tolerance, result.edge_tolerance);
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

constexpr std::size_t most_kinds = 20'000;  ///< each takes 20 to 200 milliseconds

/// Of fewer cells a boolean is sooner done than this many boxes of a body that reaches far beyond them.
bool is_worth_it(std::size_t distinct, std::uint64_t kept) { return kept > 100 || distinct <= 100 + 8 * kept; }

class LatticeMaker {
 public:
  LatticeMaker(const CellShape& cell, const Index3& last, const std::vector<TopoDS_Shape>& body,
               const ClipOptions& options, const RunOptions& run, DiagnosticSink& sink)
      : cell_(cell), last_(last), body_(body), options_(options), run_(run), sink_(sink) {
    if (cell.varied)
      varied_.emplace(cell);
    else
      reach_ = reach_of(cell);
  }

  std::optional<ClippedLattice> make() {
    if (std::max(reach().neighbours.size(), reach().rim.size()) > 64)
      return fault("the unit cell reaches too far beyond its box");
    of_lattice_ = grid_for(cell_, reach(), last_, body_);
    grid_ = grown_for(of_lattice_, options_.added);
    if (grid_.count() == 0) return ClippedLattice{};
    if (grid_.count() > run_.max_cells) return fault("the body meets too many boxes");
    if (!fit_in_memory(grid_.count(), run_, sink_)) return {};
    if (!body_.empty()) surface_.emplace(body_, grid_);
    if (!options_.added.empty()) added_.emplace(options_.added, grid_);
    KeptCells cells({.min = {}, .max = last_, .inside = {}}, grid_.min, grid_.max, [&](const Index3& index) {
      return in_body(index) || (added_ && added_->place(index) != BoxPlace::outside);
    });
    if (run_.should_stop()) return stopped();
    CellKinds kinds = first_kinds(cells);
    if (kinds.parts().size() > most_kinds)
      return fault("more boxes than " + std::to_string(most_kinds) + " are alike with none other");
    if (takes_too_many_booleans(kinds)) return too_many_booleans();
    FusedBudget budget(options_.fused.most);
    auto solids = kind_solids(cell_, reach(), kinds.parts(), run_, sink_, &budget);
    if (run_.should_stop()) return stopped();
    if (budget.is_exceeded()) return too_many_booleans();
    if (!solids) return {};
    solids_ = std::move(*solids);
    if (std::string amiss = clip(cells, kinds); !amiss.empty()) {
      if (options_.ways != CellClipper::Ways::all) return ClippedLattice{.is_given_up = true};
      return fault(std::move(amiss));
    }
    if (run_.should_stop()) return stopped();
    if (out_.kept == 0) return std::move(out_);
    try {
      if (std::string amiss = add(cells, kinds); !amiss.empty()) return fault(std::move(amiss));
    } catch (const Standard_Failure& failure) {
      return fault(what(failure));
    }
    if (run_.should_stop()) return stopped();
    if (options_.pieces == PiecesAsked::of_both_and_no_body) return std::move(out_);
    return put_together(std::move(cells), std::move(kinds));
  }

 private:
  [[nodiscard]] bool in_body(const Index3& index) const {
    return of_lattice_.has(index) && (!surface_ || surface_->place(index) != BoxPlace::outside);
  }
  [[nodiscard]] const Reach& reach() const { return varied_ ? varied_->reach() : reach_; }
  [[nodiscard]] CellKinds first_kinds(const KeptCells& cells) {
    if (!varied_) return {reach_, cells, [&](const Index3& index) { return in_body(index); }};
    return {cells, [&](const Index3& box) {
              if (!in_body(box)) return std::vector<std::uint32_t>{};
              return varied_->parts_of(box, [&](const Index3& cell) { return cells.in_pattern(cell); });
            }};
  }
  /// Before any is made: judged by the places of circles. Some that pass are joined all the same.
  [[nodiscard]] bool takes_too_many_booleans(const CellKinds& kinds) const {
    const auto& parts = kinds.parts();
    if (!varied_ || parts.size() <= options_.fused.most) return false;
    std::size_t fused = 0;
    return std::ranges::any_of(parts, [&](const auto& of_kind) {
      return !is_put_together(cell_, reach(), of_kind) && ++fused > options_.fused.most;
    });
  }
  std::nullopt_t too_many_booleans() {
    if (!options_.fused.is_told) return std::nullopt;
    const double minutes = std::ceil(0.7 * static_cast<double>(options_.fused.most) / 60);  // measured
    sink_.report({.code = Code::limit_booleans, .args = {std::to_string(options_.fused.most), format_number(minutes)}});
    return std::nullopt;
  }
  std::nullopt_t fault(std::string what) {
    sink_.report({.code = Code::geometry_not_repeatable, .args = {std::move(what)}});
    return std::nullopt;
  }
  std::nullopt_t stopped() {
    sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
    return std::nullopt;
  }
  [[nodiscard]] std::string clip(const KeptCells& cells, CellKinds& kinds);
  [[nodiscard]] std::string add(const KeptCells& cells, CellKinds& kinds);
  [[nodiscard]] std::optional<ClippedLattice> put_together(KeptCells cells, CellKinds kinds);

  const CellShape& cell_;
  Index3 last_;
  const std::vector<TopoDS_Shape>& body_;
  const ClipOptions& options_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  Reach reach_;
  std::optional<VariedBoxes> varied_;
  CellGrid of_lattice_, grid_;  ///< the boxes of the cells; and those of the body that is added
  std::optional<BodySurface> surface_, added_;
  std::vector<TopoDS_Shape> solids_;  ///< by kind
  std::vector<ClippedCell> results_;
  ClippedLattice out_;
};

/// What the body leaves of each box. Empty, or why not.
std::string LatticeMaker::clip(const KeptCells& cells, CellKinds& kinds) {
  std::vector<bool> is_cut(cells.count());
  if (surface_) {
    ClipPlan plan(*surface_, cells, kinds, grid_, options_.reuse, [&](const Index3& index) { return in_body(index); });
    const auto otherwise = [&](std::uint32_t kind, int variant) {
      return solid_in_box_otherwise(cell_, reach(), kinds.parts()[kind], variant);
    };
    clip_all(plan.tasks, solids_, otherwise, *surface_, grid_, options_.ways, run_);
    if (run_.should_stop()) return {};
    std::vector<std::uint32_t> kind_of_task;
    for (ClipTask& task : plan.tasks) {
      if (!task.result.fault.empty()) return task.result.fault;
      const bool whole = task.result.left == ClippedCell::Left::all;
      kind_of_task.push_back(whole ? task.kind : static_cast<std::uint32_t>(solids_.size()));
      if (!whole) solids_.push_back(task.result.solid);
      results_.push_back(std::move(task.result));
    }
    for (std::uint32_t n = 0; n < cells.count(); ++n) {
      const std::uint32_t task = plan.task_of(n);
      if (task == KeptCells::none) continue;
      kinds.set(n, kind_of_task[task]);
      is_cut[n] = results_[task].left == ClippedCell::Left::part;
    }
  }
  CellsOfBoxes kept(last_, options_.block), crossing(last_, options_.block);
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const Index3& cell = cells.cell(n);
    // Of a whole lattice all cells take part, and what they send over its rim is theirs.
    if (!solids_[kinds.of(cell, cells)].IsNull() && (surface_ || cells.in_pattern(cell))) kept.add(cell);
    if (is_cut[n]) crossing.add(cell);
  }
  out_.kept = kept.count();
  out_.crossing = crossing.count();
  return {};
}

/// The union with the body that is added. Empty, or why not.
std::string LatticeMaker::add(const KeptCells& cells, CellKinds& kinds) {
  if (options_.pieces != PiecesAsked::none)
    out_.cut = std::make_shared<const LatticePieces>(grid_, cells, kinds, solids_);
  if (added_) {
    UnionPlan plan(*added_, grid_, cells, kinds, solids_, options_.reuse);
    if (!is_worth_it(plan.distinct(), out_.kept)) return "the body that is added meets too many boxes";
    if (std::string fault = plan.run(kinds, solids_, results_, run_); !fault.empty()) return fault;
    if (run_.should_stop()) return {};
  }
  const auto alike = static_cast<std::uint32_t>(added_ || varied_ ? 0 : kinds.parts().size());
  if ((added_ || varied_ || out_.crossing > 0) && !align_edges(grid_, cells, alike, kinds, solids_))
    return "the walls of boxes cannot be divided alike";
  if (options_.pieces == PiecesAsked::of_both || options_.pieces == PiecesAsked::of_both_and_no_body)
    out_.joined = std::make_shared<const LatticePieces>(grid_, cells, kinds, solids_);
  return {};
}

std::optional<ClippedLattice> LatticeMaker::put_together(KeptCells cells, CellKinds kinds) {
  auto quotient =
      build_quotient(cell_, solids_, {.mesh = options_.mesh, .run = {}}, 10 * cell_.tolerance(), run_, sink_);
  if (run_.should_stop()) return stopped();
  if (!quotient) return {};
  auto made = assemble(std::move(*quotient), std::move(cells), std::move(kinds), run_, sink_);
  if (!made) return {};
  out_.body = std::move(*made);
  out_.clip = counts_of(results_, grid_.size(), sink_);
  return std::move(out_);
}

}  // namespace

std::optional<ClippedLattice> clipped_lattice_body(const CellShape& cell, const Index3& last,
                                                   const std::vector<TopoDS_Shape>& body, const ClipOptions& options,
                                                   const RunOptions& run, DiagnosticSink& sink) {
  return LatticeMaker(cell, last, body, options, run, sink).make();
}

}  // namespace meso::brep
