// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/body_sample.hpp"

#include <algorithm>

#include "meso/eval/bounds.hpp"
#include "part_fold.hpp"
#include "realise_boundary.hpp"
#include "realise_lattice.hpp"
#include "realise_part.hpp"

namespace meso::brep {
namespace {

constexpr std::uint64_t probed_cells = 1024;  ///< whose place in the macrostructure is looked at
constexpr std::size_t built_cells = 6;        ///< that become solids

/// At most `probed_cells` ordinals below `size`, so ordered that every beginning of the list is spread evenly.
std::vector<std::uint64_t> spread_ordinals(std::uint64_t size) {
  const std::uint64_t wanted = std::min(size, probed_cells);
  std::vector<std::uint64_t> out;
  for (std::uint64_t i = 0; i < probed_cells; ++i) {
    std::uint64_t reversed = 0;  // bits of i: the van der Corput sequence
    for (std::uint64_t bit = 1; bit < probed_cells; bit *= 2) reversed = 2 * reversed + (i & bit ? 1 : 0);
    if (reversed >= wanted) continue;
    const std::uint64_t low = size / wanted * reversed + size % wanted * reversed / wanted;
    const std::uint64_t room = size / wanted;
    // A jitter keeps regular steps from meeting the same index of an inner loop every time.
    out.push_back(low + (reversed * 0x9E3779B97F4A7C15u >> 32) % room);
  }
  return out;
}

/// The middle of a box and of its six sides.
std::array<Vec3, 7> probes(const Box3& box) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  std::array<Vec3, 7> out;
  out.fill(middle);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out[2 * axis][axis] = box.min[axis];
    out[2 * axis + 1][axis] = box.max[axis];
  }
  return out;
}

/// One part's left fold, with bodies by weight instead of solids.
class PartSample {
 public:
  PartSample(const eval::Evaluation& evaluation, const RealiseOptions& options, DiagnosticSink& sink)
      : evaluation_(evaluation),
        options_(options),
        parts_(evaluation, options, sink),
        context_{evaluation.checked().source(), options.run, sink, &parts_} {}

  /// `is_outermost`: not an operand of another part.
  std::optional<BodySample> fold(const Part& part, bool is_outermost) {
    BodySample state;
    Solids macrostructure;
    if (part.macrostructure) {
      auto solids = macrostructure_solids(evaluation_, part.macrostructure->text, context_);
      if (!solids) return {};
      macrostructure = std::move(*solids);
      auto body = to_body(macrostructure, options_, context_.sink);
      if (!body) return {};
      state.bodies.push_back({std::move(*body), 1});
    }
    for (const Apply& apply : part.steps) {
      const bool is_first = &apply == &part.steps.front(), is_last = &apply == &part.steps.back();
      const bool added = apply.part ? add_part(state, apply)
                                    : add_cells(state, apply, macrostructure, is_outermost && is_first && is_last);
      if (!added) return {};
    }
    return state;
  }

 private:
  bool add_part(BodySample& state, const Apply& apply) {
    const Part* part = evaluation_.find_part(apply.part->text);
    auto operand = part != nullptr ? fold(*part, false) : std::nullopt;
    if (!operand) return false;
    std::ranges::move(operand->bodies, std::back_inserter(state.bodies));
    return true;
  }

  bool add_cells(BodySample& state, const Apply& apply, const Solids& macrostructure, bool may_repeat) {
    const Pattern* pattern = apply.pattern ? evaluation_.find_pattern(apply.pattern->text) : nullptr;
    const auto cells = pattern != nullptr ? evaluation_.cells(*pattern, context_.sink) : std::nullopt;
    if (!cells) return false;
    state.cells.placed += cells->size();
    if (apply.operation == ApplyOperation::intersection) state.bodies.clear();
    const bool clips = apply.boundary.value_or(BoundaryRule::clip) == BoundaryRule::clip;
    if (may_repeat && clips && may_be_lattice(apply, macrostructure)) {
      if (auto lattice = lattice_sample(macrostructure, *cells, fineness(options_), context_)) {
        state.cells.kept += lattice->kept;
        std::ranges::move(lattice->bodies, std::back_inserter(state.bodies));
        return true;
      }
      if (context_.sink.has_errors()) return false;
    }
    return add_single_cells(state, apply, macrostructure, *cells);
  }

  bool add_single_cells(BodySample& state, const Apply& apply, const Solids& macrostructure,
                        const eval::CellStream& cells) {
    const std::vector<std::uint64_t> ordinals = spread_ordinals(cells.size());
    const Boundary boundary(macrostructure);
    std::vector<std::uint64_t> kept;
    for (const std::uint64_t ordinal : ordinals) {
      const auto keep = [&](const eval::PlacedCell& cell) {
        if (is_kept(apply, boundary, cells, cell)) kept.push_back(ordinal);
        return true;
      };
      if (!cells.visit(ordinal, ordinal + 1, keep, context_.sink) || context_.sink.has_errors()) return false;
    }
    if (kept.empty()) return true;
    const double share = static_cast<double>(kept.size()) / static_cast<double>(ordinals.size());
    const double all_kept = share * static_cast<double>(cells.size());
    state.cells.kept += static_cast<std::uint64_t>(std::llround(all_kept));
    kept.resize(std::min(kept.size(), built_cells));
    auto body = placed_body(cells, kept);
    if (!body) return false;
    state.bodies.push_back({std::move(*body), all_kept / static_cast<double>(kept.size())});
    return true;
  }

  bool is_kept(const Apply& apply, const Boundary& boundary, const eval::CellStream& cells,
               const eval::PlacedCell& cell) {
    if (apply.operation == ApplyOperation::union_) return true;
    const auto shape = cells.shape(cell, context_.sink);
    if (!shape) return false;
    const auto box = eval::bounds(*shape);
    const Vec3 at = cell.world_from_cell.translation;
    const bool in_world = cell.mapping == CellMapping::conformal;
    const Box3 world = !box ? Box3{at, at} : in_world ? *box : eval::transformed(cell.world_from_cell, *box);
    const auto is_inside = [&](Vec3 p) { return boundary.solid_at(p) >= 0; };
    if (apply.boundary.value_or(BoundaryRule::clip) == BoundaryRule::drop_partial)
      return std::ranges::all_of(probes(world), is_inside);
    return std::ranges::any_of(probes(world), is_inside);
  }

  std::optional<Body> placed_body(const eval::CellStream& cells, std::span<const std::uint64_t> ordinals) {
    const auto made = cell_solids_at(cells, ordinals, CellPart::body, context_);
    if (!made) return {};
    Solids solids;
    for (const CellSolid& cell : made->cells) std::ranges::move(made->solids_of(cell), std::back_inserter(solids));
    return to_body(solids, options_, context_.sink);
  }

  const eval::Evaluation& evaluation_;
  const RealiseOptions& options_;
  PartFold parts_;  ///< those that stand in cells
  SolidContext context_;
};

}  // namespace

std::optional<BodySample> sample_build(const eval::Evaluation& evaluation, std::optional<std::string_view> part_id,
                                       const RealiseOptions& options, DiagnosticSink& sink) {
  const Document& document = evaluation.document();
  std::vector<const Part*> parts;
  if (part_id || document.build.empty()) {
    parts = {chosen_part(evaluation, part_id, sink)};
  } else {
    for (const BuildItem& item : document.build) parts.push_back(evaluation.find_part(item.part.text));
  }
  BodySample all;
  for (const Part* part : parts) {
    if (part == nullptr) return {};
    try {
      auto sample = PartSample(evaluation, options, sink).fold(*part, true);
      if (!sample) return {};
      all.cells.placed += sample->cells.placed;
      all.cells.kept += sample->cells.kept;
      std::ranges::move(sample->bodies, std::back_inserter(all.bodies));
    } catch (const Standard_Failure& failure) {
      const SolidContext context{evaluation.checked().source(), options.run, sink};
      context.report(Code::geometry_kernel, part->id_in_source, {"sampling a part", what(failure)});
      return {};
    }
  }
  return all;
}

}  // namespace meso::brep
