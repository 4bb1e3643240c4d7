// SPDX-License-Identifier: Apache-2.0
#include "realise_fold.hpp"

#include <algorithm>

#include "boolean.hpp"
#include "meso/base/number.hpp"
#include "point_within.hpp"
#include "realise_boundary.hpp"

namespace meso::brep {
namespace {

constexpr double rule_tolerance = 1e-6;  ///< millimetres that a boundary rule forgives

ElementId where_of(const FoldContext& context) { return context.apply.id_in_source; }

bool within_budget(std::size_t solids, const FoldContext& context) {
  if (solids <= context.max_boolean_solids) return true;
  const double minutes = std::ceil(0.05 * std::pow(static_cast<double>(solids), 1.3) / 60);
  context.solid.report(Code::limit_booleans, where_of(context),
                       {std::to_string(context.max_boolean_solids), format_number(minutes)});
  return false;
}

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
      : body_(body), cells_(cells), context_(context), boundary_(body) {}

  std::optional<FoldStep> run(std::vector<bool> taken, CellCounts& counts) {
    taken_ = std::move(taken);
    if (!sort()) return {};
    counts.crossing += crossing_;
    switch (operation()) {
      case ApplyOperation::difference:
        counts.kept += apart_inside_.size() + joined_kept_;
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

 private:
  /// Whole cells stand for themselves: those rules unite cells that were chosen before.
  [[nodiscard]] ApplyOperation operation() const {
    const bool whole = context_.apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip;
    return whole && context_.apply.operation == ApplyOperation::intersection ? ApplyOperation::union_
                                                                             : context_.apply.operation;
  }

  bool sort() {
    const std::vector<bool> touching = touching_cells(cells_);
    const bool is_union = operation() == ApplyOperation::union_;
    if (!can_be_joined(touching, is_union)) return false;
    for (std::size_t i = 0; i < cells_.cells.size(); ++i) {
      if (!taken_[i]) continue;
      if (i % 64 == 0 && stopped()) return false;
      const CellSolid& cell = cells_.cells[i];
      const Place place = boundary_.place(cells_, cell);
      if (place == Place::crossing) ++crossing_;
      if (place == Place::outside && !is_union) continue;
      const bool apart = !touching[i] && cells_.prototypes[cell.prototype].is_simple;
      if (apart && place == Place::inside)
        apart_inside_.push_back(i);
      else if (apart && place == Place::outside)
        apart_outside_.push_back(i);
      else {
        ++joined_kept_;
        append(joined_, cells_.solids_of(cell));
        if (!within_budget(joined_.size(), context_)) return false;
      }
    }
    return true;
  }

  /// Refuses early: cells that touch another and reach into the body are joined, whatever a closer look would find.
  bool can_be_joined(const std::vector<bool>& touching, bool is_union) const {
    std::size_t solids = 0;
    for (std::size_t i = 0; i < cells_.cells.size() && solids <= context_.max_boolean_solids; ++i) {
      if (!taken_[i] || !touching[i]) continue;
      const Prototype& prototype = cells_.prototypes[cells_.cells[i].prototype];
      if (prototype.mesh.points.empty()) continue;
      if (is_union || boundary_.solid_at(cells_.cells[i].placement * prototype.mesh.points.front()) >= 0)
        solids += prototype.solids.size();
    }
    return within_budget(solids, context_);
  }

  bool stopped() const {
    if (!context_.solid.run.should_stop()) return false;
    context_.solid.report(context_.solid.run.out_of_time() ? Code::limit_time : Code::cancelled, where_of(context_),
                          {});
    return true;
  }

  static void append(Solids& to, const Solids& from) { to.insert(to.end(), from.begin(), from.end()); }

  std::optional<FoldStep> difference() {
    FoldStep step{body_, !joined_.empty()};
    if (!joined_.empty()) {
      auto cut_body = cut(body_, joined_, where_of(context_), context_.solid);
      if (!cut_body) return {};
      step.solids = std::move(*cut_body);
    }
    std::vector<std::vector<TopoDS_Shape>> voids(step.solids.size());
    const Boundary owners(step.solids);
    for (const std::size_t i : apart_inside_) {
      const Solids hollows = cells_.solids_of(cells_.cells[i]);
      const std::vector<Vec3> anchors = cells_.anchors_of(cells_.cells[i]);
      for (std::size_t k = 0; k < hollows.size(); ++k) {
        const int owner = step.solids.size() == 1 ? 0 : owners.solid_at(anchors[k]);
        if (owner >= 0) voids[static_cast<std::size_t>(owner)].push_back(hollows[k]);
        // Otherwise it lies in what another cutter has taken away: cannot be, the two would touch.
      }
    }
    for (std::size_t s = 0; s < step.solids.size(); ++s)
      if (!voids[s].empty()) step.solids[s] = with_voids(step.solids[s], voids[s]);
    return step;
  }

  std::optional<FoldStep> intersection() {
    FoldStep step{{}, !joined_.empty()};
    for (const std::size_t i : apart_inside_) append(step.solids, cells_.solids_of(cells_.cells[i]));
    if (joined_.empty()) return step;
    const auto joined = fuse(joined_, where_of(context_), context_.solid);
    if (!joined) return {};
    const auto clipped = common(*joined, body_, where_of(context_), context_.solid);
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
    const auto joined = joined_.empty() ? std::optional(rest) : fuse(rest, where_of(context_), context_.solid);
    if (!joined) return {};
    append(step.solids, *joined);
    return step;
  }

  const Solids& body_;
  const CellSolids& cells_;
  const FoldContext& context_;
  Boundary boundary_;
  std::vector<bool> taken_;
  std::vector<std::size_t> apart_inside_, apart_outside_;  ///< clear of everything
  Solids joined_;                                          ///< the rest: touches the boundary or another cell
  std::uint64_t joined_kept_ = 0, crossing_ = 0;
};

/// For each piece the solid of `before` that it was cut from; -1 where that cannot be told.
std::vector<int> owners_of(const Solids& pieces, const Solids& before) {
  std::vector<int> owners(pieces.size(), before.size() == 1 ? 0 : -1);
  if (before.size() <= 1) return owners;
  const Boundary boundary(before);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const Vec3 p : points_within(pieces[i], 1)) owners[i] = boundary.solid_at(p);
  return owners;
}

/// Which cells a boundary rule takes, judged by `judged` (bodies or boxes). Empty with a diagnostic on a fault.
std::optional<std::vector<bool>> taken_cells(const Solids& body, const CellSolids& judged, const FoldContext& context) {
  const BoundaryRule rule = context.apply.boundary.value_or(BoundaryRule::clip);
  std::vector<bool> taken(judged.cells.size(), true);
  if (rule == BoundaryRule::clip) return taken;
  const Boundary boundary(body);
  std::size_t booleans = 0;
  for (std::size_t i = 0; i < judged.cells.size(); ++i) {
    const Place place = boundary.place(judged, judged.cells[i]);
    if (place != Place::crossing) {
      taken[i] = place == Place::inside;
      const bool far = rule == BoundaryRule::keep_whole || context.clearance <= clear_distance || !taken[i];
      if (!far) taken[i] = boundary.distance(judged.solids_of(judged.cells[i])) >= context.clearance - rule_tolerance;
      continue;
    }
    if (!within_budget(++booleans, context)) return {};
    const Solids solids = judged.solids_of(judged.cells[i]);
    const auto part_inside = common(solids, body, where_of(context), context.solid);
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
        Code::limit_cells, where_of(context),
        {cells.pattern().id.text, std::to_string(cells.size()), std::to_string(context.solid.run.max_cells)});
    return {};
  }
  const auto bodies = cell_solids(cells, CellPart::body, context.solid);
  if (!bodies) return {};
  std::vector<bool> taken(bodies->cells.size(), true);
  if (context.apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip) {
    const bool by_box = context.apply.test.value_or(InsideTest::box) == InsideTest::box;
    const auto regions = by_box ? cell_solids(cells, CellPart::region, context.solid) : std::nullopt;
    if (by_box && !regions) return {};
    const auto judged = taken_cells(body, by_box ? *regions : *bodies, context);
    if (!judged) return {};
    taken = *judged;
  }
  return CellStep(body, *bodies, context).run(std::move(taken), counts);
}

std::optional<FoldStep> apply_solids(const Solids& body, const Solids& operand, const FoldContext& context) {
  if (!within_budget(body.size() + operand.size(), context)) return {};
  std::optional<Solids> solids;
  switch (context.apply.operation) {
    case ApplyOperation::difference:
      solids = cut(body, operand, where_of(context), context.solid);
      break;
    case ApplyOperation::intersection:
      solids = common(body, operand, where_of(context), context.solid);
      break;
    case ApplyOperation::union_: {
      Solids all = body;
      all.insert(all.end(), operand.begin(), operand.end());
      solids = fuse(all, where_of(context), context.solid);
    }
  }
  if (!solids) return {};
  return FoldStep{std::move(*solids), true};
}

bool settle_fragments(Solids& solids, const Solids& before, const FoldContext& context, const std::string& part,
                      CellCounts& counts) {
  const bool cuts = context.apply.operation != ApplyOperation::union_ &&
                    context.apply.boundary.value_or(BoundaryRule::clip) == BoundaryRule::clip;
  if (!cuts) return true;
  // Largest first: the first piece of each solid is that solid, cut; the others are its fragments.
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < solids.size(); ++i) order.emplace_back(-brep::volume_of(solids[i]), i);
  std::ranges::stable_sort(order, {}, [](const auto& piece) { return piece.first; });
  const std::vector<int> owners = owners_of(solids, before);
  std::vector<bool> seen(before.size() + 1, false), is_loose(solids.size(), false);
  std::size_t loose = 0;
  for (const auto& [volume, i] : order) {
    const auto owner = static_cast<std::size_t>(owners[i] + 1);
    if (seen[owner]) {
      is_loose[i] = true;
      ++loose;
    }
    seen[owner] = true;
  }
  if (loose == 0) return true;
  counts.fragments += loose;
  switch (context.apply.fragments.value_or(FragmentRule::keep)) {
    case FragmentRule::keep:
      return true;
    case FragmentRule::drop: {
      Solids kept;
      for (std::size_t i = 0; i < solids.size(); ++i)
        if (!is_loose[i]) kept.push_back(solids[i]);
      solids = std::move(kept);
      return true;
    }
    case FragmentRule::error:
      break;
  }
  context.solid.report(Code::geometry_fragments, where_of(context), {part, std::to_string(loose)});
  return false;
}

}  // namespace meso::brep
