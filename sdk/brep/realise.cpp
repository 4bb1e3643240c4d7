// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/realise.hpp"

#include <algorithm>
#include <chrono>
#include <map>

#include "boolean.hpp"
#include "in_memory.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/placement.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "part_fold.hpp"
#include "realise_part.hpp"
#include "shape_to_body.hpp"
#include "solid_primitive.hpp"
#include "solid_shape.hpp"

namespace meso::brep {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void place(Body& body, const Affine& world_from_part) {
  body.pieces_volume *= determinant(world_from_part.linear);
  for (Solid& solid : body.solids) {
    solid.outer.placement = world_from_part * solid.outer.placement;
    for (Shell& hollow : solid.voids) hollow.placement = world_from_part * hollow.placement;
  }
}

void append(Realisation& to, Realisation from) {
  const bool is_known = from.body.pieces_volume > 0 && (to.body.solids.empty() || to.body.pieces_volume > 0);
  to.body.pieces_volume = is_known ? to.body.pieces_volume + from.body.pieces_volume : 0;
  std::ranges::move(from.body.solids, std::back_inserter(to.body.solids));
  to.body.fragments += from.body.fragments;
  to.cells.placed += from.cells.placed;
  to.cells.kept += from.cells.kept;
  to.cells.crossing += from.cells.crossing;
  to.clip.distinct += from.clip.distinct;
  to.clip.attempts.resize(std::max(to.clip.attempts.size(), from.clip.attempts.size()));
  for (std::size_t n = 0; n < from.clip.attempts.size(); ++n) to.clip.attempts[n] += from.clip.attempts[n];
  to.clip.edge_tolerance = std::max(to.clip.edge_tolerance, from.clip.edge_tolerance);
  to.cells.fragments += from.cells.fragments;
  to.cells.dropped += from.cells.dropped;
  to.way = std::move(from.way);
  to.evaluate_seconds += from.evaluate_seconds;
  to.realise_seconds += from.realise_seconds;
}

/// Parts one by one, as plain values. What several are made of is made once, and so is a part that is listed twice.
class Builder {
 public:
  Builder(const eval::Evaluation& evaluation, const RealiseOptions& options, DiagnosticSink& sink)
      : evaluation_(evaluation),
        options_(options),
        sink_(sink),
        context_{evaluation.checked().source(), options.run, sink},
        fold_(evaluation, options, sink) {}

  std::optional<Realisation> make(const Part& part) {
    const auto start = Clock::now();
    if (const auto known = made_.find(&part); known != made_.end()) {
      Realisation again = known->second;
      again.evaluate_seconds = again.realise_seconds = 0;
      return again;
    }
    try {
      auto result = fresh(part);
      if (!result) return {};
      result->realise_seconds = seconds_since(start);
      return made_.emplace(&part, std::move(*result)).first->second;
    } catch (const Standard_Failure& failure) {
      context_.report(Code::geometry_kernel, part.id_in_source, {"realising a part", what(failure)});
      return {};
    }
  }

 private:
  std::optional<Realisation> fresh(const Part& part) {
    auto folded = fold_.outermost(part);
    if (!folded) return {};
    if (folded->body ? folded->body->solids.empty() : folded->solids.empty()) {
      sink_.report(eval::empty_part(evaluation_, part));
      return {};
    }
    Realisation result{
        .body = {}, .cells = folded->counts, .clip = std::move(folded->clip), .way = std::move(folded->way)};
    auto body = folded->body ? std::move(folded->body) : to_body(folded->solids, options_, sink_);
    if (!body) return {};
    if (!folded->body) body->pieces_volume = folded->pieces_volume;
    result.body = std::move(*body);
    result.body.fragments = result.cells.fragments;
    return result;
  }

  const eval::Evaluation& evaluation_;
  const RealiseOptions& options_;
  DiagnosticSink& sink_;
  SolidContext context_;
  PartFold fold_;
  std::map<const Part*, Realisation> made_;
};

}  // namespace

std::optional<MeshFineness> fineness(const RealiseOptions& options) {
  if (!options.mesh) return {};
  return MeshFineness{options.deflection_mm, options.angle_rad};
}

std::optional<Body> to_body(const Solids& solids, const RealiseOptions& options, DiagnosticSink& sink) {
  ShapeToBodyOptions to_body_options;
  if (const auto mesh = fineness(options)) to_body_options.mesh = MeshTolerance{mesh->deflection, mesh->angle};
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& solid : solids) builder.Add(compound, solid);
  return shape_to_body(compound, to_body_options, sink);
}

std::optional<Solids> macrostructure_solids(const eval::Evaluation& evaluation, const std::string& id,
                                            const SolidContext& context) {
  const auto& all = evaluation.document().macrostructures;
  const auto found = std::ranges::find(all, id, [](const Macrostructure& m) { return m.id.text; });
  if (found == all.end()) return {};
  const auto shape = evaluation.shape(*found, context.sink);
  return shape ? solid_from_shape(*shape, {}, context) : std::nullopt;
}

std::optional<Solids> solids_from(const Body& body, Edges edges) {
  DiagnosticSink unused;
  const auto shape = edges == Edges::mended ? to_shape(body, unused) : to_shape_as_is(body, unused);
  if (!shape) return {};
  Solids solids = solids_of(*shape);
  double volume = 0;
  for (const TopoDS_Shape& solid : solids) volume += brep::volume_of(solid);
  const double expected = measure(body).volume;
  if (solids.size() != body.solids.size() || !(std::fabs(volume - expected) <= 1e-6 * expected)) return {};
  return solids;
}

bool may_be_lattice(const Apply& apply, const Solids& body) {
  return apply.operation == (body.empty() ? ApplyOperation::union_ : ApplyOperation::intersection) &&
         (apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip ||
          apply.fragments.value_or(FragmentRule::keep) == FragmentRule::keep || body.size() == 1);
}

const Part* chosen_part(const eval::Evaluation& evaluation, std::optional<std::string_view> part_id,
                        DiagnosticSink& sink) {
  const Document& document = evaluation.document();
  const Part* part = part_id                      ? evaluation.find_part(*part_id)
                     : document.parts.size() == 1 ? &document.parts.items.front()
                                                  : nullptr;
  if (part != nullptr) return part;
  std::string ids;
  for (const Part& p : document.parts) ids += (ids.empty() ? "" : ", ") + p.id.text;
  sink.report({.code = Code::usage,
               .args = {part_id ? "there is no part '" + std::string(*part_id) + "'; the parts are " + ids
                                : "the document has no build; name one of its parts: " + ids}});
  return nullptr;
}

std::optional<Realisation> realise(const eval::Evaluation& evaluation, const Part& part, const RealiseOptions& options,
                                   DiagnosticSink& sink) {
  return Builder(evaluation, options, sink).make(part);
}

std::optional<Body> realise_macrostructure(const eval::Evaluation& evaluation, const Macrostructure& macrostructure,
                                           const RealiseOptions& options, DiagnosticSink& sink) {
  const SolidContext context{evaluation.checked().source(), options.run, sink};
  const auto shape = evaluation.shape(macrostructure, sink);
  const auto solids = shape ? solid_from_shape(*shape, {}, context) : std::nullopt;
  if (!solids) return {};
  try {
    return to_body(*solids, options, sink);
  } catch (const Standard_Failure& failure) {
    context.report(Code::geometry_kernel, macrostructure.id_in_source, {"realising a macrostructure", what(failure)});
    return {};
  }
}

std::optional<Realisation> realise_build(const eval::Evaluation& evaluation, std::optional<std::string_view> part_id,
                                         const RealiseOptions& options, DiagnosticSink& sink) {
  const Document& document = evaluation.document();
  if (part_id || document.build.empty()) {
    const Part* part = chosen_part(evaluation, part_id, sink);
    return part != nullptr ? realise(evaluation, *part, options, sink) : std::nullopt;
  }
  Builder builder(evaluation, options, sink);
  Realisation all;
  for (const BuildItem& item : document.build) {
    const Part* part = evaluation.find_part(item.part.text);
    const auto placement = evaluation.placement(item.placement, sink);
    if (part == nullptr || !placement) return {};
    if (!is_similarity(*placement) || determinant(placement->linear) < 0) {
      const SolidContext context{evaluation.checked().source(), options.run, sink};
      context.report(Code::brep_not_realised, item.id_in_source, {"a build item that is mirrored or stretched"});
      return {};
    }
    auto made = builder.make(*part);
    if (!made) return {};
    place(made->body, *placement);
    append(all, std::move(*made));
  }
  return all;
}

}  // namespace meso::brep
