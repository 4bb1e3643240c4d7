// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_selection.hpp"

#include <deque>
#include <map>

#include "boolean.hpp"
#include "lattice/cell_clipper.hpp"
#include "lattice/clip_signature.hpp"
#include "lattice/parallel.hpp"
#include "meso/brep/instance_map.hpp"
#include "realise_boundary.hpp"

namespace meso::brep {
namespace {

constexpr double rule_tolerance = 1e-6;  ///< millimetres that a boundary rule forgives

/// What is judged of a cell: a solid in each of the boxes it reaches into.
struct Judged {
  std::vector<Index3> shifts;  ///< the box counts from the cell's own
  std::vector<TopoDS_Shape> solids;
  std::vector<double> volumes;
  double volume = 0, area = 0;

  void add(const Index3& shift, const TopoDS_Shape& solid) {
    GProp_GProps of_volume, of_surface;
    BRepGProp::VolumeProperties(solid, of_volume);
    BRepGProp::SurfaceProperties(solid, of_surface);
    shifts.push_back(shift);
    solids.push_back(solid);
    volumes.push_back(of_volume.Mass());
    volume += of_volume.Mass();
    area += of_surface.Mass();
  }
};

std::optional<Judged> judged_by(const CellShape& cell, InsideTest test, const RunOptions& run, DiagnosticSink& sink) {
  Judged judged;
  if (test == InsideTest::box) {
    judged.add({}, BRepPrimAPI_MakeBox(to_pnt(cell.box.min), to_pnt(cell.box.max)).Solid());
    return judged;
  }
  const Reach reach = reach_of(cell);
  const auto add = [&](const Index3& shift, const std::vector<std::uint32_t>& parts) {
    const auto solid = solid_in_box(cell, reach, parts, run, sink);
    if (solid && !solid->IsNull()) judged.add(shift, *solid);
    return solid.has_value();
  };
  if (!add({}, reach.own)) return {};
  for (const Reach::Neighbour& neighbour : reach.rim)
    if (!add({-neighbour.shift[0], -neighbour.shift[1], -neighbour.shift[2]}, neighbour.parts)) return {};
  return judged;
}

CellGrid grid_around(const CellShape& cell, const Judged& judged, const Index3& last) {
  CellGrid grid{.first = cell.box, .min = {}, .max = last, .tolerance = cell.tolerance()};
  for (const Index3& shift : judged.shifts)
    for (std::size_t i = 0; i < 3; ++i) {
      grid.min[i] = std::min(grid.min[i], shift[i]);
      grid.max[i] = std::max(grid.max[i], last[i] + shift[i]);
    }
  return grid;
}

/// How much of each solid in each crossing box lies in the body: a boolean for all boxes that see the same.
class Shares {
 public:
  Shares(const Judged& judged, const BodySurface& surface, const CellGrid& grid)
      : judged_(judged), surface_(surface), grid_(grid), signatures_(surface.body(), grid) {}

  /// The task that tells; run() does it.
  [[nodiscard]] std::size_t ask(std::uint32_t solid, const Index3& box) {
    auto found = signature_of_.find(box);
    if (found == signature_of_.end())
      found = signature_of_.emplace(box, signatures_.of(box, surface_.faces(box))).first;
    ClipSignatures::Signature key = found->second;
    key.push_back(solid);
    const auto [it, fresh] = known_.emplace(std::move(key), tasks_.size());
    if (fresh) tasks_.push_back({.solid = solid, .box = box, .volume = 0, .fault = {}});
    return it->second;
  }
  /// Does what was asked since the last time. Empty, or the first fault.
  [[nodiscard]] std::string run(const RunOptions& run) {
    std::deque<CellClipper> clippers;
    for (std::size_t i = 0; i < workers_for(tasks_.size() - done_, run); ++i)
      clippers.emplace_back(judged_.solids, CellClipper::Otherwise{}, surface_, grid_, run);
    (void)in_parallel(tasks_.size() - done_, run, [&](std::size_t worker, std::size_t i) {
      Task& task = tasks_[done_ + i];
      ClippedCell clipped = clippers[worker].clip(task.solid, task.box, surface_.faces(task.box));
      task.fault = std::move(clipped.fault);
      if (clipped.left == ClippedCell::Left::all) task.volume = judged_.volumes[task.solid];
      if (clipped.left == ClippedCell::Left::part) task.volume = volume_of(clipped.solid);
      return task.fault.empty();
    });
    done_ = tasks_.size();
    for (const Task& task : tasks_)
      if (!task.fault.empty()) return task.fault;
    return {};
  }
  [[nodiscard]] double volume(std::size_t task) const { return tasks_[task].volume; }
  [[nodiscard]] std::uint32_t solid(std::size_t task) const { return tasks_[task].solid; }

 private:
  struct Task {
    std::uint32_t solid = 0;
    Index3 box{};
    double volume = 0;
    std::string fault;
  };
  const Judged& judged_;
  const BodySurface& surface_;
  CellGrid grid_;
  ClipSignatures signatures_;
  std::map<Index3, ClipSignatures::Signature> signature_of_;
  std::map<ClipSignatures::Signature, std::size_t> known_;
  std::vector<Task> tasks_;
  std::size_t done_ = 0;
};

template <typename Visit>
void visit_cells(const Index3& last, const Visit& visit) {
  for (Index3 cell{}; cell[0] <= last[0]; ++cell[0])
    for (cell[1] = 0; cell[1] <= last[1]; ++cell[1])
      for (cell[2] = 0; cell[2] <= last[2]; ++cell[2]) visit(cell);
}

/// Whether any box within `layers` of the cell meets a face.
bool near_surface(const BodySurface& surface, const CellGrid& grid, const Index3& cell, const Index3& layers) {
  Index3 at;
  for (at[0] = cell[0] - layers[0]; at[0] <= cell[0] + layers[0]; ++at[0])
    for (at[1] = cell[1] - layers[1]; at[1] <= cell[1] + layers[1]; ++at[1])
      for (at[2] = cell[2] - layers[2]; at[2] <= cell[2] + layers[2]; ++at[2]) {
        bool on_grid = true;
        for (std::size_t i = 0; i < 3; ++i) on_grid = on_grid && at[i] >= grid.min[i] && at[i] <= grid.max[i];
        // Beyond the grid nothing is known.
        if (!on_grid || !surface.faces(at).empty()) return true;
      }
  return false;
}

class Selection {
 public:
  Selection(const CellShape& cell, const Index3& last, const std::vector<TopoDS_Shape>& body, const CellRule& rule,
            const Judged& judged, const RunOptions& run)
      : rule_(rule),
        judged_(judged),
        last_(last),
        body_(body),
        grid_(grid_around(cell, judged, last)),
        surface_(body, grid_),
        run_(run) {}

  /// Empty, or a fault. Boxes that need no geometry speak first, then the cell's own box, then what is still in doubt.
  [[nodiscard]] std::string judge() {
    Shares shares(judged_, surface_, grid_);
    std::vector<std::vector<std::size_t>> asked;
    const auto parts = static_cast<std::uint32_t>(judged_.shifts.size());
    for (const bool own : {true, false}) {
      const std::uint32_t first = own ? 0 : 1, end = own ? std::min(1u, parts) : parts;
      asked.clear();
      std::size_t n = 0;
      visit_cells(last_, [&](const Index3& cell) {
        std::vector<std::size_t>& tasks = asked.emplace_back();
        if (own) count_whole_boxes(cell);
        if (!decided(n++))
          for (std::uint32_t s = first; s < end; ++s)
            if (const Index3 box = cell + judged_.shifts[s]; surface_.place(box) == BoxPlace::crossing)
              tasks.push_back(shares.ask(s, box));
      });
      if (std::string fault = shares.run(run_); !fault.empty()) return fault;
      for (n = 0; n < inside_.size(); ++n)
        for (const std::size_t task : asked[n]) {
          inside_[n] += shares.volume(task);
          outside_[n] += judged_.volumes[shares.solid(task)] - shares.volume(task);
        }
    }
    take();
    return {};
  }

  [[nodiscard]] CellSelection selection() && {
    CellSelection out;
    for (std::size_t n = 0; n < taken_.size(); ++n) {
      out.kept += taken_[n];
      out.crossing += taken_[n] && judged_.volume - inside_[n] > forgiven();
    }
    out.set = {.min = {}, .max = last_, .inside = [taken = std::move(taken_), last = last_](Index3 cell) -> bool {
                 const auto at = [&](std::size_t i) { return static_cast<std::size_t>(cell[i]); };
                 return taken[(at(0) * (at_least(last[1])) + at(1)) * at_least(last[2]) + at(2)];
               }};
    return out;
  }

 private:
  void count_whole_boxes(const Index3& cell) {
    double inside = 0, outside = 0;
    for (std::uint32_t s = 0; s < judged_.shifts.size(); ++s) {
      const BoxPlace place = surface_.place(cell + judged_.shifts[s]);
      if (place == BoxPlace::inside) inside += judged_.volumes[s];
      if (place == BoxPlace::outside) outside += judged_.volumes[s];
    }
    inside_.push_back(inside);
    outside_.push_back(outside);
  }
  [[nodiscard]] bool decided(std::size_t n) const {
    return (rule_.rule == BoundaryRule::drop_partial ? outside_[n] : inside_[n]) > forgiven();
  }

  static std::size_t at_least(std::int32_t last) { return static_cast<std::size_t>(last) + 1; }
  [[nodiscard]] double forgiven() const { return rule_tolerance * judged_.area; }

  void take() {
    const bool whole = rule_.rule == BoundaryRule::drop_partial;
    const Boundary boundary(body_);
    std::size_t n = 0;
    visit_cells(last_, [&](const Index3& cell) {
      bool taken = decided(n++) != whole;
      if (taken && whole && rule_.clearance > rule_tolerance && !run_.should_stop())
        taken = keeps_clear(boundary, cell);
      taken_.push_back(taken);
    });
  }
  [[nodiscard]] bool keeps_clear(const Boundary& boundary, const Index3& cell) const {
    Index3 layers;
    for (std::size_t i = 0; i < 3; ++i)
      layers[i] = static_cast<std::int32_t>(std::fmin(std::ceil(rule_.clearance / grid_.size()[i]), 1e6));
    std::vector<TopoDS_Shape> near;
    for (std::size_t s = 0; s < judged_.shifts.size(); ++s) {
      const Index3 box = cell + judged_.shifts[s];
      if (!near_surface(surface_, grid_, box, layers)) continue;
      const Vec3 by = grid_.origin(box) - grid_.first.min;
      gp_Trsf move;
      move.SetTranslation(gp_Vec(by.x, by.y, by.z));
      near.push_back(judged_.solids[s].Moved(TopLoc_Location(move)));
    }
    return near.empty() || boundary.distance(near) >= rule_.clearance - rule_tolerance;
  }

  const CellRule& rule_;
  const Judged& judged_;
  Index3 last_;
  const std::vector<TopoDS_Shape>& body_;
  CellGrid grid_;
  BodySurface surface_;
  const RunOptions& run_;
  std::vector<double> inside_, outside_;  ///< volume of what is judged, as far as it is known; per cell
  std::vector<bool> taken_;
};

}  // namespace

std::optional<CellSelection> select_cells(const CellShape& cell, const Index3& last,
                                          const std::vector<TopoDS_Shape>& body, const CellRule& rule,
                                          const RunOptions& run, DiagnosticSink& sink) {
  const auto stopped = [&] {
    if (!run.should_stop()) return false;
    sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    return true;
  };
  const std::optional<Judged> judged = judged_by(cell, rule.test, run, sink);
  if (stopped() || !judged) return {};
  Selection selection(cell, last, body, rule, *judged, run);
  const std::string fault = selection.judge();
  if (stopped()) return {};
  if (!fault.empty()) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {fault}});
    return {};
  }
  return std::move(selection).selection();
}

}  // namespace meso::brep
