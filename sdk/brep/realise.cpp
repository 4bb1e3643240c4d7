// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/realise.hpp"

#include <algorithm>
#include <chrono>
#include <map>

#include "boolean.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/placement.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "realise_beam_graph.hpp"
#include "realise_boundary.hpp"
#include "realise_fold.hpp"
#include "realise_lattice.hpp"
#include "realise_part.hpp"
#include "shape_to_body.hpp"
#include "solid_primitive.hpp"
#include "solid_shape.hpp"
#include "surface_point.hpp"

namespace meso::brep {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A body while the fold goes on: solids, or, after the last step, the repeated template of a lattice.
struct Folded {
  Solids solids;
  double pieces_volume = 0;  ///< of what they were put together from; 0: not known
  std::optional<Body> body;
};

void keep_largest(Body& body) {
  const auto volume = [](const Solid& solid) { return measure(Body{.solids = {solid}, .fragments = 0}).volume; };
  body.solids = {*std::ranges::max_element(body.solids, {}, volume)};
  body.pieces_volume = 0;
}

Box3 box_of_all(const Solids& solids) {
  Box3 all;
  for (const TopoDS_Shape& solid : solids) {
    const Box3 one = box_of(solid);
    all.extend(one.min);
    all.extend(one.max);
  }
  return all;
}

/// The solid that a vertex or, where all lie on the boundary, the point nearest to the middle of a face is in.
std::size_t owner_of(const Solid& piece, const Boundary& boundary) {
  const Shell& shell = piece.outer;
  const Template& geometry = *shell.geometry;
  int owner = -1;
  const auto ask = [&](Vec3 p, const Index3& cell) {
    if (owner < 0) owner = boundary.solid_at(shell.placement * (p + cell_origin(geometry, cell)));
  };
  shell.visit([&](const FaceInstance& instance) {
    const FaceTemplate& face = geometry.faces[instance.face];
    for (const auto& loop : face.loops)
      for (const Coedge& use : loop) {
        const EdgeTemplate& edge = geometry.edges[use.edge];
        ask(geometry.vertices[edge.vertex[0]], instance.cell + use.offset + edge.vertex_offset[0]);
      }
    ask(nearest_point(face.surface, 0.5 * (face.box.min + face.box.max)), instance.cell);
  });
  return static_cast<std::size_t>(std::max(owner, 0));
}

CellCounts sum_of(const CellCounts& a, const CellCounts& b) {
  return {a.placed + b.placed, a.kept + b.kept, a.crossing + b.crossing, a.fragments + b.fragments,
          a.dropped + b.dropped};
}

/// How many of the solids `pieces` was cut from it has pieces of.
std::size_t solids_cut(const Body& pieces, const Solids& before) {
  if (before.size() == 1) return std::min<std::size_t>(pieces.solids.size(), 1);
  const Boundary boundary(before);
  std::vector<bool> is_left(before.size());
  for (const Solid& piece : pieces.solids) is_left[owner_of(piece, boundary)] = true;
  return static_cast<std::size_t>(std::ranges::count(is_left, true));
}

class PartFold {
 public:
  PartFold(const eval::Evaluation& evaluation, const RealiseOptions& options, DiagnosticSink& sink)
      : evaluation_(evaluation), options_(options), context_{evaluation.checked().source(), options.run, sink} {}

  std::optional<Folded> fold(const Part& part, bool is_outermost) {
    Folded state;
    if (part.macrostructure) {
      auto solids = macrostructure_solids(evaluation_, part.macrostructure->text, context_);
      if (!solids) return {};
      state.solids = std::move(*solids);
    }
    for (std::size_t i = 0; i < part.steps.size(); ++i) {
      options_.run.report("realise", static_cast<double>(i) / static_cast<double>(part.steps.size()));
      const bool last = i + 1 == part.steps.size();
      if (!step(state, part, part.steps[i], is_outermost && last)) return {};
    }
    return state;
  }

  CellCounts counts;
  ClipCounts clip;
  std::string way = "direct";

 private:
  bool step(Folded& state, const Part& part, const Apply& apply, bool is_last) {
    if (apply.radius || apply.skin) {
      context_.report(Code::brep_not_realised, apply.id_in_source,
                      {apply.radius ? "fillets of a radius between operands" : "skins of a thickness"});
      return false;
    }
    FoldContext context{context_, apply, 0, options_.max_boolean_solids};
    if (apply.clearance) {
      const auto clearance = evaluation_.value(*apply.clearance, apply.id_in_source, "clearance", context_.sink);
      if (!clearance) return false;
      context.clearance = *clearance * millimeters_per(evaluation_.document().unit);
    }
    const Solids before = state.solids;
    std::optional<FoldStep> made;
    if (apply.pattern) {
      const Pattern* pattern = evaluation_.find_pattern(apply.pattern->text);
      const auto cells = pattern != nullptr ? evaluation_.cells(*pattern, context_.sink) : std::nullopt;
      if (!cells || !eval::check_reach(evaluation_, *cells, apply, part, box_of_all(state.solids), {}, context_.sink))
        return false;
      const Thickness thickness = strut_thickness(*cells, context_.sink);
      if (context_.sink.has_errors() || !struts_fit(thickness, 0.5, apply)) return false;
      const bool is_union = apply.operation == ApplyOperation::union_ && state.solids.empty();
      const bool may_be_graph = is_last && is_union && may_be_beam_graph(*cells);
      const bool graph_first = may_be_graph && has_touching_circles(*cells);
      if (graph_first && try_beam_graph(state, *cells, apply)) return true;
      if (context_.sink.has_errors()) return false;
      if (is_last && may_be_lattice(apply, state.solids) && try_lattice(state, *cells, context, part.id.text))
        return true;
      if (context_.sink.has_errors()) return false;
      if (may_be_graph && !graph_first && try_beam_graph(state, *cells, apply)) return true;
      if (context_.sink.has_errors() || !struts_fit(thickness, 0.4, apply)) return false;
      made = is_union ? apply_beams(*cells, context) : std::nullopt;
      if (context_.sink.has_errors()) return false;
      if (!made) made = apply_cells(state.solids, *cells, context, counts);
      if (made && !made->reaches && !state.solids.empty() && eval::must_reach(*cells, apply)) {
        eval::report_no_reach(evaluation_, *cells, part, context_.sink);
        return false;
      }
    } else if (apply.part) {
      made = apply_part(state.solids, apply, context);
    }
    if (!made) return false;
    state.solids = std::move(made->solids);
    way = made->used_booleans ? "boolean" : "cells";
    const std::size_t solids = state.solids.size();
    if (!settle_fragments(state.solids, before, context, part.id.text, counts)) return false;
    state.pieces_volume = state.solids.size() == solids ? made->pieces_volume : 0;
    return true;
  }

  /// Booleans of struts that fill their cells take minutes and fail. Half a cell is refused before anything is tried.
  bool struts_fit(const Thickness& thickness, double most, const Apply& apply) {
    if (thickness.ratio() <= most) return true;
    context_.report(
        Code::geometry_struts_thick, apply.id_in_source,
        {"radius " + format_number(thickness.radius) + " mm in cells of " + format_number(thickness.edge) + " mm"});
    return false;
  }

  bool try_lattice(Folded& state, const eval::CellStream& cells, const FoldContext& context, const std::string& part) {
    const Apply& apply = context.apply;
    if (cells.size() > options_.run.max_cells) return false;
    std::optional<CellRule> whole_cells;
    if (const auto rule = apply.boundary.value_or(BoundaryRule::clip); rule != BoundaryRule::clip)
      whole_cells = CellRule{rule, apply.test.value_or(InsideTest::box), context.clearance};
    auto lattice = lattice_part(state.solids, cells, whole_cells, fineness(options_), context_);
    if (!lattice) return false;
    counts.placed += cells.size();
    counts.kept += lattice->kept;
    counts.crossing += lattice->crossing;
    clip = std::move(lattice->clip);
    // A union has no fragments; of each solid of a cut body that anything is left of, one piece is that solid.
    const std::size_t cut = whole_cells || state.solids.empty() ? 0 : solids_cut(lattice->body, state.solids);
    lattice->body.fragments = cut == 0 ? 0 : lattice->body.solids.size() - cut;
    counts.fragments += lattice->body.fragments;
    if (lattice->body.fragments > 0) {
      const FragmentRule rule = apply.fragments.value_or(FragmentRule::keep);
      if (rule == FragmentRule::drop) {
        keep_largest(lattice->body);
        counts.dropped += lattice->body.fragments;
      }
      if (rule == FragmentRule::error) {
        context_.report(Code::geometry_fragments, apply.id_in_source, {part, std::to_string(lattice->body.fragments)});
        return false;
      }
    }
    state.body = std::move(lattice->body);
    way = "lattice";
    return true;
  }

  bool try_beam_graph(Folded& state, const eval::CellStream& cells, const Apply& apply) {
    if (cells.size() > options_.run.max_cells) return false;
    auto graph = beam_graph_part(cells, apply.id_in_source, {fineness(options_), options_.run}, context_);
    if (!graph) return false;
    counts.placed += cells.size();
    counts.kept += graph->kept;
    state.body = std::move(graph->body);
    way = "beamGraph";
    return true;
  }

  /// Beams that cells share are joined once. Nothing, and no error, where the cells are to be joined as they are.
  std::optional<FoldStep> apply_beams(const eval::CellStream& cells, const FoldContext& context) {
    if (!may_be_beam_graph(cells) || cells.size() > options_.run.max_cells) return {};
    const auto primitives = beam_graph_primitives(cells, context_);
    if (!primitives) return {};
    auto made = apply_solids({}, *primitives, context);
    if (!made) return {};
    counts.placed += cells.size();
    counts.kept += cells.size();
    return made;
  }

  std::optional<FoldStep> apply_part(const Solids& body, const Apply& apply, const FoldContext& context) {
    const Part* part = evaluation_.find_part(apply.part->text);
    const auto placement = evaluation_.placement(apply.placement, context_.sink);
    if (part == nullptr || !placement) return {};
    const Operand* operand = operand_of(*part);
    if (operand == nullptr) return {};
    counts = sum_of(counts, operand->counts);
    Solids solids = operand->solids;
    for (TopoDS_Shape& solid : solids) solid = mapped(solid, *placement);
    return apply_solids(body, solids, context);
  }

  /// A part that others are made of. It has no parameters, so it is made once, however often it is applied.
  struct Operand {
    Solids solids;
    CellCounts counts;
  };
  const Operand* operand_of(const Part& part) {
    if (const auto known = operands_.find(&part); known != operands_.end()) return &known->second;
    const CellCounts outside = std::exchange(counts, {});
    auto folded = fold(part, false);
    const CellCounts inside = std::exchange(counts, outside);
    return folded ? &operands_.emplace(&part, Operand{std::move(folded->solids), inside}).first->second : nullptr;
  }

  const eval::Evaluation& evaluation_;
  const RealiseOptions& options_;
  SolidContext context_;
  std::map<const Part*, Operand> operands_;
};

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
  const auto start = Clock::now();
  const SolidContext context{evaluation.checked().source(), options.run, sink};
  try {
    PartFold fold(evaluation, options, sink);
    auto folded = fold.fold(part, true);
    if (!folded) return {};
    if (folded->body ? folded->body->solids.empty() : folded->solids.empty()) {
      context.report(Code::geometry_empty, part.id_in_source, {part.id.text});
      return {};
    }
    Realisation result{.body = {}, .cells = fold.counts, .clip = std::move(fold.clip), .way = std::move(fold.way)};
    auto body = folded->body ? std::move(folded->body) : to_body(folded->solids, options, sink);
    if (!body) return {};
    if (!folded->body) body->pieces_volume = folded->pieces_volume;
    result.body = std::move(*body);
    result.body.fragments = result.cells.fragments;
    result.realise_seconds = seconds_since(start);
    return result;
  } catch (const Standard_Failure& failure) {
    context.report(Code::geometry_kernel, part.id_in_source, {"realising a part", what(failure)});
    return {};
  }
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
    auto made = realise(evaluation, *part, options, sink);
    if (!made) return {};
    place(made->body, *placement);
    append(all, std::move(*made));
  }
  return all;
}

}  // namespace meso::brep
