// SPDX-License-Identifier: Apache-2.0
#include "lattice/united_cells.hpp"

#include "boolean.hpp"
#include "lattice/clip_signature.hpp"
#include "lattice/parallel.hpp"

namespace meso::brep {
namespace {

Index3 beside(const Index3& cell, std::size_t side) {
  Index3 other = cell;
  other[side / 2] += side % 2 != 0 ? 1 : -1;
  return other;
}

}  // namespace

/// What the lattice holds there and the body does not swallow.
std::uint32_t UnionPlan::kind_at(const Index3& cell) const {
  if (!grid_.has(cell) || cells_.number(cell) == none || surface_.place(cell) == BoxPlace::inside) return none;
  const std::uint32_t kind = kinds_.of(cell, cells_);
  return solids_[kind].IsNull() ? none : kind;
}

const BoxWalls& UnionPlan::walls(std::uint32_t kind) {
  const auto known = walls_.find(kind);
  if (known != walls_.end()) return known->second;
  return walls_.emplace(kind, walls_of(solids_[kind], grid_.first, 4 * grid_.tolerance)).first->second;
}

Vec3 UnionPlan::shift_to(std::size_t side) const {
  Vec3 shift;
  shift[side / 2] = (side % 2 != 0 ? 1 : -1) * grid_.size()[side / 2];
  return shift;
}

UnionPlan::FrameKey UnionPlan::frame_of(const Index3& cell) {
  FrameKey key{.own = kind_at(cell)};
  for (std::size_t side = 0; side < 6; ++side) {
    const std::uint32_t other = kind_at(beside(cell, side));
    if (other == none) continue;
    const WallFaces& theirs = walls(other)[side ^ 1];
    if (theirs.faces.empty()) continue;
    const Vec3 size = grid_.size();
    if (key.own != none &&
        walls(key.own)[side].is_same(theirs, shift_to(side), std::fmin(size.x, std::fmin(size.y, size.z))))
      continue;
    key.beside[side] = other;
  }
  return key;
}

UnionPlan::UnionPlan(const BodySurface& surface, const CellGrid& grid, const KeptCells& cells, const CellKinds& kinds,
                     const std::vector<TopoDS_Shape>& solids, bool reuse)
    : surface_(surface), grid_(grid), cells_(cells), kinds_(kinds), solids_(solids) {
  const ClipSignatures signatures(surface_.body(), grid_);
  std::map<FrameKey, std::uint32_t> known_frames;
  std::map<ClipSignatures::Signature, std::uint32_t> known;
  task_of_.assign(cells_.count(), none);
  for (std::uint32_t n = 0; n < cells_.count(); ++n) {
    const Index3& cell = cells_.cell(n);
    const BoxPlace place = surface_.place(cell);
    if (place == BoxPlace::outside) continue;
    const FrameKey key = frame_of(cell);
    const auto [frame, fresh_frame] = known_frames.emplace(key, static_cast<std::uint32_t>(frames_.size()));
    if (fresh_frame) frames_.push_back(key);
    const bool is_full = place == BoxPlace::inside;
    ClipSignatures::Signature seen = is_full ? ClipSignatures::Signature{} : signatures.of(cell, surface_.faces(cell));
    seen.push_back(frame->second);
    seen.push_back(is_full);
    if (!reuse && !is_full) seen.push_back(n);
    const auto [task, fresh] = known.emplace(std::move(seen), static_cast<std::uint32_t>(tasks_.size()));
    if (fresh) tasks_.push_back({.frame = frame->second, .cell = cell, .is_full = is_full});
    task_of_[n] = task->second;
  }
}

std::vector<TopoDS_Shape> UnionPlan::outlines_of(const FrameKey& key) const {
  std::vector<TopoDS_Shape> outlines;
  for (std::size_t side = 0; side < 6; ++side) {
    if (key.beside[side] == none) continue;
    const Vec3 by = shift_to(side);
    gp_Trsf move;
    move.SetTranslation(gp_Vec(by.x, by.y, by.z));
    outlines.push_back(compound_of(walls_.at(key.beside[side])[side ^ 1].faces).Moved(TopLoc_Location(move)));
  }
  return outlines;
}

void UnionPlan::make_all(const RunOptions& run) {
  const auto frame = [&](std::uint32_t number, int variant) {
    if (variant > 0) return WholeCell{};
    const FrameKey& key = frames_[number];
    return box_frame(key.own == none ? TopoDS_Shape() : solids_[key.own], grid_.first, outlines_of(key),
                     deflection_in(grid_), run);
  };
  std::deque<CellClipper> clippers;  // they cannot be moved
  for (std::size_t i = 0; i < workers_for(tasks_.size(), run); ++i) clippers.emplace_back(frame, surface_, grid_, run);
  (void)in_parallel(tasks_.size(), run, [&](std::size_t worker, std::size_t i) {
    Task& task = tasks_[i];
    if (!task.is_full) {
      task.result = clippers[worker].clip(task.frame, task.cell, surface_.faces(task.cell));
      return task.result.fault.empty();
    }
    try {
      task.result = {.left = ClippedCell::Left::part,
                     .solid = filled_box(grid_.first, outlines_of(frames_[task.frame]), run)};
    } catch (const Standard_Failure& failure) {
      task.result = {.fault = what(failure)};
    }
    return task.result.fault.empty();
  });
}

std::string UnionPlan::run(CellKinds& kinds, std::vector<TopoDS_Shape>& solids, std::vector<ClippedCell>& results,
                           const RunOptions& run) {
  make_all(run);
  if (run.should_stop()) return {};
  std::vector<std::uint32_t> kind_of_task(tasks_.size(), none);
  std::vector<TopoDS_Shape> fresh;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    ClippedCell& result = tasks_[t].result;
    if (!result.fault.empty()) return result.fault;
    if (result.left == ClippedCell::Left::part) {
      kind_of_task[t] = static_cast<std::uint32_t>(solids.size() + fresh.size());
      fresh.push_back(result.solid);
    }
    results.push_back(std::move(result));
  }
  for (std::uint32_t n = 0; n < cells_.count(); ++n)
    if (const std::uint32_t task = task_of_[n]; task != none && kind_of_task[task] != none)
      kinds.set(n, kind_of_task[task]);
  solids.insert(solids.end(), fresh.begin(), fresh.end());
  return {};
}

}  // namespace meso::brep
