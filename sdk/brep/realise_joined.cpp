// SPDX-License-Identifier: Apache-2.0
#include "realise_joined.hpp"

#include <algorithm>
#include <set>

#include "boolean.hpp"
#include "meso/brep/measure.hpp"
#include "realise_boundary.hpp"

namespace meso::brep {
namespace {

/// Not so where fragments are left out before the next step.
bool keeps_everything(const Apply& apply) {
  return !apply.radius && !apply.skin && apply.boundary.value_or(BoundaryRule::clip) == BoundaryRule::clip &&
         apply.fragments.value_or(FragmentRule::keep) == FragmentRule::keep;
}

struct JoinedBodies {
  std::optional<Solids> clip;  ///< nothing: the lattice is whole
  Solids removed;              ///< of a whole lattice
  Solids added;

  /// One more step. False, with a diagnostic, if a boolean of the bodies fails.
  [[nodiscard]] bool apply(const Solids& operand, const FoldContext& context);

  [[nodiscard]] LatticeRequest request() const {
    return {.clip = clip.value_or(Solids{}), .removed = removed, .added = added};
  }
};

bool JoinedBodies::apply(const Solids& operand, const FoldContext& context) {
  const auto changed = [&](Solids& body) {
    if (body.empty()) return true;
    auto made = apply_solids(body, operand, context);
    if (made) body = std::move(made->solids);
    return made.has_value();
  };
  switch (context.apply.operation) {
    case ApplyOperation::union_:
      if (!added.empty()) return changed(added);
      added = operand;
      return true;
    case ApplyOperation::difference:
      if (!clip) removed.insert(removed.end(), operand.begin(), operand.end());
      return (!clip || changed(*clip)) && changed(added);
    case ApplyOperation::intersection:
      break;
  }
  if (clip) return changed(*clip) && changed(added);
  clip = operand;
  if (!removed.empty()) {
    auto left = cut(*clip, removed, context.where(), context.solid);
    if (!left) return false;
    clip = std::move(*left);
    removed.clear();
  }
  return changed(added);
}

/// Of each solid before the cut that anything is left of, one piece is that solid.
template <typename At>
std::size_t fragments_of(const ConnectedPieces& after, const At& before_at) {
  std::set<std::size_t> owners;
  for (const std::optional<Vec3>& p : after.points)
    if (const auto owner = p ? before_at(*p) : std::nullopt) owners.insert(*owner);
  return after.points.size() - std::min(after.points.size(), std::max<std::size_t>(owners.size(), 1));
}

/// The bodies step by step, and what of the lattice there is after each: made when a cut asks for it.
class Joining {
 public:
  Joining(const Solids& before, const Apply& pattern, const eval::CellStream& cells, const FoldContext& context)
      : before_(before), pattern_(pattern), cells_(cells), context_(context) {
    (is_cut() ? bodies_.clip.emplace() : bodies_.added) = before;
  }

  std::optional<JoinedLattice> run(const std::vector<BodyStep>& rest, const std::optional<MeshFineness>& mesh) {
    std::optional<ConnectedPieces> now;  // of what the bodies are now, if a cut has asked
    bool asks_first = is_cut();
    for (const BodyStep& step : rest) {
      const bool cuts = step.apply->operation != ApplyOperation::union_;
      if (cuts && !now) {
        auto made = pieces();
        if (!made) return {};
        if (asks_first) fragments_ += fragments_of(*made->cut, owner_in_before());
        asks_first = false;
        now = std::move(made->joined);
      }
      const FoldContext of_step{context_.solid, *step.apply, 0, context_.max_boolean_solids};
      if (!bodies_.apply(step.operand, of_step) || (bodies_.clip && bodies_.clip->empty())) return {};
      if (!cuts) now.reset();
      if (!cuts || &step == &rest.back()) continue;
      auto made = pieces();
      if (!made) return {};
      fragments_ += fragments_of(*made->joined, now->at);
      now = std::move(made->joined);
    }
    LatticeRequest request = bodies_.request();
    request.mesh = mesh;
    request.pieces = now ? PiecesAsked::of_both : asks_first ? PiecesAsked::of_cut : PiecesAsked::none;
    auto part = lattice_part(request, cells_, context_.solid);
    if (!part || part->kept == 0 || !holds_what_was_added(part->body)) return {};
    if (now) fragments_ += fragments_of(*part->joined, now->at);
    if (!now && asks_first) fragments_ += fragments_of(*part->cut, owner_in_before());
    return JoinedLattice{std::move(*part), fragments_};
  }

 private:
  [[nodiscard]] bool is_cut() const { return pattern_.operation == ApplyOperation::intersection; }
  /// No union is smaller than one of its operands.
  [[nodiscard]] bool holds_what_was_added(const Body& body) const {
    double least = 0;
    for (const TopoDS_Shape& solid : bodies_.added) least += volume_of(solid);
    if (measure(body).volume >= least * (1 - 1e-6)) return true;
    context_.solid.sink.report({.code = Code::geometry_not_repeatable, .args = {"a piece of the body is lost"}});
    return false;
  }
  [[nodiscard]] std::optional<LatticePart> pieces() const {
    LatticeRequest request = bodies_.request();
    request.pieces = PiecesAsked::of_both_and_no_body;
    auto part = lattice_part(request, cells_, context_.solid);
    return part && part->cut && part->joined ? std::move(part) : std::nullopt;
  }
  [[nodiscard]] std::function<std::optional<std::size_t>(Vec3)> owner_in_before() const {
    return [boundary = std::make_shared<Boundary>(before_)](Vec3 p) {
      const int solid = boundary->solid_at(p);
      return solid < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(solid));
    };
  }

  const Solids& before_;
  const Apply& pattern_;
  const eval::CellStream& cells_;
  const FoldContext& context_;
  JoinedBodies bodies_;
  std::size_t fragments_ = 0;
};

}  // namespace

bool may_join(const Part& part, std::size_t at, const Solids& before) {
  const Apply& pattern = part.steps[at];
  if (!pattern.pattern || !keeps_everything(pattern)) return false;
  const bool is_union = pattern.operation == ApplyOperation::union_;
  if (!is_union && (pattern.operation != ApplyOperation::intersection || before.empty())) return false;
  const auto rest = std::ranges::subrange(part.steps.begin() + static_cast<std::ptrdiff_t>(at) + 1, part.steps.end());
  if (rest.empty() && (!is_union || before.empty())) return false;
  return std::ranges::all_of(rest, [](const Apply& step) { return step.part && keeps_everything(step); });
}

std::optional<JoinedLattice> joined_lattice(const Solids& before, const Apply& pattern, const eval::CellStream& cells,
                                            const std::vector<BodyStep>& rest, const std::optional<MeshFineness>& mesh,
                                            const FoldContext& context) {
  return Joining(before, pattern, cells, context).run(rest, mesh);
}

}  // namespace meso::brep
