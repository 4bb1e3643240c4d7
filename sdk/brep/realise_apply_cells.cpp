// SPDX-License-Identifier: Apache-2.0
// The cells of a pattern against a body: voids, holes and solids of their own where they keep clear of the rest,
// booleans where they do not.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>

#include "boolean.hpp"
#include "realise_boundary.hpp"
#include "realise_contacts.hpp"
#include "realise_drill.hpp"
#include "realise_fold.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr double rule_tolerance = 1e-6;  ///< millimetres that a boundary rule forgives

double volume_of(const Solids& solids) {
  double volume = 0;
  for (const TopoDS_Shape& solid : solids) volume += brep::volume_of(solid);
  return volume;
}

double area_of(const Solids& solids) {
  double area = 0;
  for (const TopoDS_Shape& solid : solids) {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(solid, properties);
    area += properties.Mass();
  }
  return area;
}

bool stopped(const FoldContext& context) {
  if (!context.solid.run.should_stop()) return false;
  context.solid.report(context.solid.run.out_of_time() ? Code::limit_time : Code::cancelled, context.where(), {});
  return true;
}

/// A solid and further voids in it.
TopoDS_Shape with_voids(const TopoDS_Shape& solid, const std::vector<TopoDS_Shape>& voids) {
  const BRep_Builder builder;
  TopoDS_Solid result;
  builder.MakeSolid(result);
  for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next()) builder.Add(result, it.Current());
  for (const TopoDS_Shape& hollow : voids)
    for (TopExp_Explorer it(hollow, TopAbs_SHELL); it.More(); it.Next()) builder.Add(result, it.Current().Reversed());
  return result;
}

/// The cells of one step, sorted by what happens to them.
class CellStep {
 public:
  CellStep(const Solids& body, const CellSolids& cells, const FoldContext& context)
      : body_(body), cells_(cells), context_(context), boundary_(body), drill_(body) {}

  std::optional<FoldStep> run(std::vector<bool> taken, CellCounts& counts) {
    taken_ = std::move(taken);
    if (!sort()) return {};
    counts.crossing += crossing_;
    switch (operation()) {
      case ApplyOperation::difference:
        counts.kept += apart_inside_.size() + drilled_.size() + joined_kept_;
        return difference();
      case ApplyOperation::intersection:
        counts.kept += apart_inside_.size() + joined_kept_;
        return intersection();
      case ApplyOperation::union_:
        break;
    }
    counts.kept += static_cast<std::uint64_t>(std::ranges::count(taken_, true));
    return union_();
  }

  /// Is one of the cells inside of the body, or across its boundary?
  [[nodiscard]] bool reaches() const { return is_any_near_ || !drilled_.empty(); }

 private:
  /// Whole cells stand for themselves: those rules unite cells that were chosen before.
  [[nodiscard]] ApplyOperation operation() const {
    const bool whole = context_.apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip;
    return whole && context_.apply.operation == ApplyOperation::intersection ? ApplyOperation::union_
                                                                             : context_.apply.operation;
  }

  bool sort() {
    const Clusters clusters = clusters_of(cells_, taken_);
    const bool is_union = operation() == ApplyOperation::union_;
    if (!can_be_joined(clusters, is_union)) return false;
    for (std::size_t i = 0; i < cells_.cells.size(); ++i) {
      if (!taken_[i]) continue;
      if (i % 64 == 0 && stopped(context_)) return false;
      const CellSolid& cell = cells_.cells[i];
      const bool apart = clusters.is_alone(i) && cells_.prototypes[cell.prototype].is_simple;
      if (apart && operation() == ApplyOperation::difference && drill_.add(cells_, cell)) {
        drilled_.push_back(i);
        ++crossing_;
        continue;
      }
      const Place place = boundary_.place(cells_, cell);
      if (place == Place::crossing) ++crossing_;
      is_any_near_ = is_any_near_ || place != Place::outside;
      if (place == Place::outside && !is_union) continue;
      if (apart && place == Place::inside)
        apart_inside_.push_back(i);
      else if (apart && place == Place::outside)
        apart_outside_.push_back(i);
      else {
        ++joined_kept_;
        Cluster& cluster = joined_clusters_[clusters.of_cell[i]];
        cluster.cells.push_back(i);
        cluster.is_enclosed = cluster.is_enclosed && place == Place::inside;
      }
    }
    return join();
  }

  /// Clusters that cutters enclosed in the body form are joined each alone, everything else at once.
  bool join() {
    for (auto& [first, cluster] : joined_clusters_) {
      Solids solids;
      for (const std::size_t i : cluster.cells) append(solids, cells_.solids_of(cells_.cells[i]));
      if (!context_.within_budget(solids.size())) return false;
      if (operation() == ApplyOperation::difference && cluster.is_enclosed) {
        enclosed_.push_back(std::move(cluster.cells));
      } else {
        append(joined_, solids);
        if (!context_.within_budget(joined_.size())) return false;
      }
    }
    return true;
  }

  /// Refuses early: cells that touch another and reach into the body are joined, whatever a closer look would find; as
  /// cutters perhaps only with their own cluster.
  bool can_be_joined(const Clusters& clusters, bool is_union) const {
    std::map<std::uint32_t, std::size_t> by_cluster;
    const bool apart = operation() == ApplyOperation::difference;
    std::size_t most = 0;
    for (std::size_t i = 0; i < cells_.cells.size() && most <= context_.most_solids(); ++i) {
      if (!taken_[i] || clusters.is_alone(i)) continue;
      const Prototype& prototype = cells_.prototypes[cells_.cells[i].prototype];
      if (prototype.anchors.empty()) continue;
      if (!is_union && boundary_.solid_at(cells_.cells[i].placement * prototype.anchors.front()) < 0) continue;
      most = std::max(most, by_cluster[apart ? clusters.of_cell[i] : 0] += prototype.solids.size());
    }
    return context_.within_budget(most);
  }

  /// Each prototype integrated once.
  [[nodiscard]] double volume_of_cells(const std::vector<std::size_t>& which) const {
    std::vector<std::size_t> uses(cells_.prototypes.size(), 0);
    for (const std::size_t i : which) ++uses[cells_.cells[i].prototype];
    double volume = 0;
    for (std::size_t p = 0; p < uses.size(); ++p)
      if (uses[p] > 0) volume += static_cast<double>(uses[p]) * volume_of(cells_.prototypes[p].solids);
    return volume;
  }

  static void append(Solids& to, const Solids& from) { to.insert(to.end(), from.begin(), from.end()); }

  std::optional<FoldStep> difference() {
    FoldStep step{body_, !joined_.empty() || !enclosed_.empty()};
    if (!step.used_booleans && drilled_.empty()) step.pieces_volume = volume_of(body_) - volume_of_cells(apart_inside_);
    if (!joined_.empty()) {
      auto cut_body = cut(body_, joined_, context_.where(), context_.solid);
      if (!cut_body) return {};
      step.solids = std::move(*cut_body);
    }
    if (!drilled_.empty() && !drill_into(step)) return {};
    if (apart_inside_.empty() && enclosed_.empty()) return step;
    std::vector<std::vector<TopoDS_Shape>> voids(step.solids.size());
    std::optional<Boundary> owners;
    if (step.solids.size() > 1) owners.emplace(step.solids);
    const auto owner_at = [&](Vec3 p) { return owners ? owners->solid_at(p) : 0; };
    for (const std::size_t i : apart_inside_) {
      const Solids hollows = cells_.solids_of(cells_.cells[i]);
      const std::vector<Vec3> anchors = cells_.anchors_of(cells_.cells[i]);
      for (std::size_t k = 0; k < hollows.size(); ++k) {
        const int owner = owner_at(anchors[k]);
        if (owner >= 0) voids[static_cast<std::size_t>(owner)].push_back(hollows[k]);
        // Otherwise it lies in what another cutter has taken away: cannot be, the two would touch.
      }
    }
    if (!hollow_out_clusters(step.solids, owner_at, voids)) return {};
    for (std::size_t s = 0; s < voids.size(); ++s)
      if (!voids[s].empty()) step.solids[s] = with_voids(step.solids[s], voids[s]);
    return step;
  }

  /// Clusters of cutters, fused, become voids; what such a cluster encloses stays, as a solid of its own.
  bool hollow_out_clusters(Solids& solids, const std::function<int(Vec3)>& owner_at,
                           std::vector<std::vector<TopoDS_Shape>>& voids) {
    for (const std::vector<std::size_t>& cluster : enclosed_) {
      if (stopped(context_)) return false;
      const CellSolid& first = cells_.cells[cluster.front()];
      const auto fused = fused_in_frame_of(first, cluster);
      if (!fused) return false;
      const int owner = owner_at(cells_.anchors_of(first).front());
      if (owner < 0) continue;
      for (const TopoDS_Shape& solid : *fused)
        for (TopExp_Explorer it(mapped(solid, first.placement), TopAbs_SHELL); it.More(); it.Next()) {
          if (brep::volume_of(it.Current()) > 0)
            voids[static_cast<std::size_t>(owner)].push_back(it.Current());
          else
            solids.push_back(BRepBuilderAPI_MakeSolid(TopoDS::Shell(it.Current().Reversed())).Solid());
        }
    }
    return true;
  }

  /// Clusters of the same arrangement are fused once.
  const Solids* fused_in_frame_of(const CellSolid& first, const std::vector<std::size_t>& cluster) {
    const Affine first_from_world = inverse_of_rigid(first.placement);
    std::vector<std::int64_t> key;
    Solids operands;
    for (const std::size_t i : cluster) {
      const CellSolid& cell = cells_.cells[i];
      const Affine map = first_from_world * cell.placement;
      key.push_back(static_cast<std::int64_t>(cell.prototype));
      for (const double m : map.linear.m) key.push_back(std::llround(m * 1e8));
      for (std::size_t a = 0; a < 3; ++a) key.push_back(std::llround(map.translation[a] * 1e7));
      for (const TopoDS_Shape& solid : cells_.prototypes[cell.prototype].solids) operands.push_back(mapped(solid, map));
    }
    const auto known = fused_.find(key);
    if (known != fused_.end()) return &known->second;
    auto fused = fuse(operands, context_.where(), context_.solid);
    return fused ? &fused_.emplace(std::move(key), std::move(*fused)).first->second : nullptr;
  }

  /// The boolean made other faces: the holes are found again in those. They keep clear of what it took away.
  bool drill_into(FoldStep& step) const {
    if (joined_.empty()) {
      step.solids = drill_.drilled();
      return true;
    }
    Drill drill(step.solids);
    Solids left;
    for (const std::size_t i : drilled_)
      if (!drill.add(cells_, cells_.cells[i])) append(left, cells_.solids_of(cells_.cells[i]));
    step.solids = drill.drilled();
    if (left.empty()) return true;
    auto rest = cut(step.solids, left, context_.where(), context_.solid);
    if (rest) step.solids = std::move(*rest);
    return rest.has_value();
  }

  std::optional<FoldStep> intersection() {
    FoldStep step{{}, !joined_.empty()};
    for (const std::size_t i : apart_inside_) append(step.solids, cells_.solids_of(cells_.cells[i]));
    if (joined_.empty()) {
      step.pieces_volume = volume_of_cells(apart_inside_);
      return step;
    }
    const auto joined = fuse(joined_, context_.where(), context_.solid);
    if (!joined) return {};
    const auto clipped = common(*joined, body_, context_.where(), context_.solid);
    if (!clipped) return {};
    append(step.solids, *clipped);
    return step;
  }

  std::optional<FoldStep> union_() {
    // Cells inside the body add nothing to it, unless the rule unites them without it.
    const bool with_body = context_.apply.operation == ApplyOperation::union_;
    FoldStep step{{}, false};
    if (!with_body)
      for (const std::size_t i : apart_inside_) append(step.solids, cells_.solids_of(cells_.cells[i]));
    for (const std::size_t i : apart_outside_) append(step.solids, cells_.solids_of(cells_.cells[i]));
    Solids rest = with_body ? body_ : Solids{};
    append(rest, joined_);
    step.used_booleans = !joined_.empty();
    const auto joined = joined_.empty() ? std::optional(rest) : fuse(rest, context_.where(), context_.solid);
    if (!joined) return {};
    append(step.solids, *joined);
    return step;
  }

  struct Cluster {
    std::vector<std::size_t> cells;
    bool is_enclosed = true;
  };

  const Solids& body_;
  const CellSolids& cells_;
  const FoldContext& context_;
  Boundary boundary_;
  Drill drill_;
  std::map<std::uint32_t, Cluster> joined_clusters_;   ///< of cells that are not clear of everything
  std::vector<std::vector<std::size_t>> enclosed_;     ///< those of them that are clear of the body's boundary
  std::map<std::vector<std::int64_t>, Solids> fused_;  ///< by arrangement
  std::vector<bool> taken_;
  std::vector<std::size_t> drilled_;                       ///< straight holes through plane faces
  std::vector<std::size_t> apart_inside_, apart_outside_;  ///< clear of everything
  Solids joined_;                                          ///< the rest: touches the boundary or another cell
  std::uint64_t joined_kept_ = 0, crossing_ = 0;
  bool is_any_near_ = false;
};

/// Which cells a boundary rule takes, judged by `judged` (bodies or boxes); `reaches`: one of all is not outside. Empty
/// with a diagnostic on a fault.
std::optional<std::vector<bool>> taken_cells(const Solids& body, const CellSolids& judged, const FoldContext& context,
                                             bool& reaches) {
  const BoundaryRule rule = context.apply.boundary.value_or(BoundaryRule::clip);
  std::vector<bool> taken(judged.cells.size(), true);
  if (rule == BoundaryRule::clip) return taken;
  const Boundary boundary(body);
  std::size_t booleans = 0;
  for (std::size_t i = 0; i < judged.cells.size(); ++i) {
    if (i % 64 == 0 && stopped(context)) return {};
    const Place place = boundary.place(judged, judged.cells[i]);
    reaches = reaches || place != Place::outside;
    if (place != Place::crossing) {
      taken[i] = place == Place::inside;
      const bool far = rule == BoundaryRule::keep_whole || context.clearance <= clear_distance || !taken[i];
      if (!far) taken[i] = boundary.is_clear_by(context.clearance - rule_tolerance, judged, judged.cells[i]);
      continue;
    }
    // What crosses is nearer than any clearance, or a corner says that it is not inside.
    taken[i] = rule == BoundaryRule::keep_whole || (context.clearance <= clear_distance + rule_tolerance &&
                                                    !boundary.sticks_out(rule_tolerance, judged, judged.cells[i]));
    if (!taken[i]) continue;
    if (!context.within_budget(++booleans)) return {};
    const Solids solids = judged.solids_of(judged.cells[i]);
    const auto part_inside = common(solids, body, context.where(), context.solid);
    if (!part_inside) return {};
    const double inside = volume_of(*part_inside), forgiven = rule_tolerance * area_of(solids);
    taken[i] = rule == BoundaryRule::keep_whole
                   ? inside > forgiven
                   : volume_of(solids) - inside <= forgiven && context.clearance <= rule_tolerance;
  }
  return taken;
}

}  // namespace

std::optional<FoldStep> apply_cells(const Solids& body, const eval::CellStream& cells, const FoldContext& context,
                                    CellCounts& counts) {
  counts.placed += cells.size();
  if (cells.size() > context.solid.run.max_cells) {
    context.solid.report(
        Code::limit_cells, context.where(),
        {cells.pattern().id.text, std::to_string(cells.size()), std::to_string(context.solid.run.max_cells)});
    return {};
  }
  const auto bodies = cell_solids(cells, CellPart::body, context.solid);
  if (!bodies) return {};
  std::vector<bool> taken(bodies->cells.size(), true);
  bool reaches = false;
  if (context.apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip) {
    const bool by_box = context.apply.test.value_or(InsideTest::box) == InsideTest::box;
    const auto regions = by_box ? cell_solids(cells, CellPart::region, context.solid) : std::nullopt;
    if (by_box && !regions) return {};
    const auto judged = taken_cells(body, by_box ? *regions : *bodies, context, reaches);
    if (!judged) return {};
    taken = *judged;
  }
  CellStep cell_step(body, *bodies, context);
  auto step = cell_step.run(std::move(taken), counts);
  if (step) step->reaches = reaches || cell_step.reaches();
  return step;
}

}  // namespace meso::brep
