// SPDX-License-Identifier: Apache-2.0
#include "realise_fold.hpp"

#include <algorithm>

#include "boolean.hpp"
#include "box_pairs.hpp"
#include "meso/base/number.hpp"
#include "point_within.hpp"
#include "realise_boundary.hpp"

namespace meso::brep {
namespace {

/// For each piece the solid of `before` that it was cut from; -1 where that cannot be told.
std::vector<int> owners_of(const Solids& pieces, const Solids& before) {
  std::vector<int> owners(pieces.size(), before.size() == 1 ? 0 : -1);
  if (before.size() <= 1) return owners;
  const Boundary boundary(before);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const Vec3 p : points_within(pieces[i], 8))
      if ((owners[i] = boundary.solid_at(p)) >= 0) break;
  return owners;
}

/// Solids that are joined with another: those that keep apart cost nothing.
std::size_t count_meeting(const Solids& a, const Solids& b) {
  std::vector<Box3> boxes;
  for (const Solids* solids : {&a, &b})
    for (const TopoDS_Shape& solid : *solids) boxes.push_back(box_of(solid));
  std::vector<bool> meets(boxes.size());
  visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) { meets[i] = meets[k] = true; });
  return static_cast<std::size_t>(std::ranges::count(meets, true));
}

}  // namespace

std::size_t FoldContext::most_solids() const {
  return apply.operation == ApplyOperation::difference ? 10 * max_boolean_solids : max_boolean_solids;
}

bool FoldContext::within_budget(std::size_t solids) const {
  if (solids <= most_solids()) return true;
  // Measured: cutting with 1 000 and 2 500 solids takes 11 and 35 s of a processor.
  const double each = apply.operation == ApplyOperation::difference ? 0.0015 : 0.05;
  const double minutes = std::ceil(each * std::pow(static_cast<double>(solids), 1.3) / 60);
  solid.report(Code::limit_booleans, where(), {std::to_string(most_solids()), format_number(minutes)});
  return false;
}

std::optional<FoldStep> apply_solids(const Solids& body, const Solids& operand, const FoldContext& context) {
  std::size_t joined = body.size() + operand.size();
  if (context.apply.operation == ApplyOperation::union_ && joined > context.most_solids())
    joined = count_meeting(body, operand);
  if (!context.within_budget(joined)) return {};
  std::optional<Solids> solids;
  switch (context.apply.operation) {
    case ApplyOperation::difference:
      solids = cut(body, operand, context.where(), context.solid);
      break;
    case ApplyOperation::intersection:
      solids = common(body, operand, context.where(), context.solid);
      break;
    case ApplyOperation::union_: {
      Solids all = body;
      all.insert(all.end(), operand.begin(), operand.end());
      solids = fuse(all, context.where(), context.solid);
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
  const std::vector<int> owners = owners_of(solids, before);
  const auto group_of = [&](std::size_t i) { return static_cast<std::size_t>(owners[i] + 1); };
  std::vector<std::size_t> group_sizes(before.size() + 1, 0);
  for (std::size_t i = 0; i < solids.size(); ++i) ++group_sizes[group_of(i)];
  // Largest first: the first piece of each solid is that solid, cut; the others are its fragments.
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < solids.size(); ++i)
    if (group_sizes[group_of(i)] > 1) order.emplace_back(-brep::volume_of(solids[i]), i);
  std::ranges::stable_sort(order, {}, [](const auto& piece) { return piece.first; });
  std::vector<bool> seen(before.size() + 1, false), is_loose(solids.size(), false);
  std::size_t loose = 0;
  for (const auto& [volume, i] : order) {
    if (seen[group_of(i)]) {
      is_loose[i] = true;
      ++loose;
    }
    seen[group_of(i)] = true;
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
      counts.dropped += loose;
      return true;
    }
    case FragmentRule::error:
      break;
  }
  context.solid.report(Code::geometry_fragments, context.where(), {part, std::to_string(loose)});
  return false;
}

}  // namespace meso::brep
