// SPDX-License-Identifier: Apache-2.0
#include "part_fold.hpp"

#include <algorithm>

#include "boolean.hpp"
#include "in_memory.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/placement.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "realise_beam_graph.hpp"
#include "realise_boundary.hpp"
#include "realise_graph_step.hpp"
#include "realise_joined.hpp"
#include "realise_lattice.hpp"
#include "realise_part.hpp"
#include "solid_primitive.hpp"
#include "step_telling.hpp"
#include "surface_point.hpp"

namespace meso::brep {
namespace {

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

/// How many of the solids `pieces` was cut from it has pieces of.
std::size_t solids_cut(const Body& pieces, const Solids& before) {
  if (before.size() == 1) return std::min<std::size_t>(pieces.solids.size(), 1);
  const Boundary boundary(before);
  std::vector<bool> is_left(before.size());
  for (const Solid& piece : pieces.solids) is_left[owner_of(piece, boundary)] = true;
  return static_cast<std::size_t>(std::ranges::count(is_left, true));
}

/// Booleans of struts that fill their cells take minutes and fail. Half a cell, or a block, is refused before anything
/// is tried.
bool struts_fit(const Thickness& thickness, double most, const FoldContext& context) {
  if (thickness.ratio() <= most && !thickness.is_block) return true;
  const bool by_balls = thickness.ball > thickness.edge;
  context.solid.report(
      Code::geometry_struts_thick, context.where(),
      {(by_balls ? "balls of radius " + format_number(thickness.ball) : "radius " + format_number(thickness.radius)) +
       " mm in cells of " + format_number(thickness.edge) + " mm" +
       (thickness.is_block ? ", which leave nothing of a cell open" : "")});
  return false;
}

/// Where the beams are no graph, cells that differ are joined one by one if they are few.
bool may_take_booleans(bool may_be_joined, const std::string& why_no_graph, const FoldContext& context) {
  if (may_be_joined) return true;
  context.solid.report(Code::brep_not_realised, context.where(),
                       {"beams that differ and meet a body: " + why_no_graph});
  return false;
}

}  // namespace

CellCounts sum_of(const CellCounts& a, const CellCounts& b) {
  return {a.placed + b.placed, a.kept + b.kept, a.crossing + b.crossing, a.fragments + b.fragments,
          a.dropped + b.dropped};
}

CellCounts without_fragments(CellCounts counts) {
  counts.fragments = counts.dropped = 0;
  return counts;
}

std::optional<FoldedPart> PartFold::fold(const Part& part, bool is_outermost) {
  FoldedPart state;
  if (part.macrostructure) {
    auto solids = macrostructure_solids(evaluation_, part.macrostructure->text, context_);
    if (!solids) return {};
    state.solids = std::move(*solids);
  }
  if (part.steps.size() > 1 && try_beams(state, part, is_outermost)) return state;
  if (context_.sink.has_errors()) return {};
  for (std::size_t i = 0; i < part.steps.size(); ++i) {
    // What the part is made of is made within one of its steps.
    if (is_outermost) done_ = static_cast<double>(i) / static_cast<double>(part.steps.size());
    options_.run.report("realise", done_);
    const bool last = i + 1 == part.steps.size();
    if (is_outermost && may_join(part, i, state.solids) && try_joined(state, part, i)) return state;
    if (context_.sink.has_errors()) return {};
    if (!step(state, part, part.steps[i], is_outermost && last)) return {};
  }
  return state;
}

bool PartFold::step(FoldedPart& state, const Part& part, const Apply& apply, bool stays_body) {
  if (apply.radius || apply.skin) {
    context_.report(Code::brep_not_realised, apply.id_in_source,
                    {apply.radius ? "fillets of a radius between operands" : "skins of a thickness"});
    return false;
  }
  FoldContext context{context_, apply, 0, options_.max_boolean_solids, done_};
  if (apply.clearance) {
    const auto clearance = evaluation_.value(*apply.clearance, apply.id_in_source, "clearance", context_.sink);
    if (!clearance) return false;
    context.clearance = *clearance * millimeters_per(evaluation_.document().unit);
  }
  const Solids before = state.solids;
  bool is_done = false;
  auto made = apply.pattern ? apply_pattern(state, part, context, stays_body, is_done) : apply_part(state, context);
  if (is_done || made)
    if (const Part* inner = apply.pattern ? part_in_cells(*evaluation_.find_pattern(apply.pattern->text)) : nullptr)
      state.counts = sum_of(state.counts, counts_inside(*inner));
  if (is_done) return true;
  if (!made) return false;
  state.solids = std::move(made->solids);
  state.way = made->used_booleans ? "boolean" : "cells";
  const std::size_t solids = state.solids.size();
  if (!settle_fragments(state.solids, before, context, part.id.text, state.counts)) return false;
  state.pieces_volume = state.solids.size() == solids ? made->pieces_volume : 0;
  return true;
}

std::optional<FoldStep> PartFold::apply_pattern(FoldedPart& state, const Part& part, const FoldContext& context,
                                                bool stays_body, bool& is_done) {
  const Apply& apply = context.apply;
  const Pattern* pattern = evaluation_.find_pattern(apply.pattern->text);
  const auto cells = pattern != nullptr ? evaluation_.cells(*pattern, context_.sink) : std::nullopt;
  if (!cells || !eval::check_reach(evaluation_, *cells, apply, part, box_of_all(state.solids), {}, context_.sink))
    return {};
  const Thickness thickness = strut_thickness(*cells, context_.sink);
  if (context_.sink.has_errors() || !struts_fit(thickness, 0.5, context)) return {};
  const bool may_be_graph = may_be_graph_step(state.solids, *cells, context), differ = !cells->lattice();
  if (!may_be_graph || !differ || struts_part_on_balls(*cells, context_))
    is_done =
        try_template(state, part, *cells, context, stays_body, may_be_graph ? FusedLimit{0, false} : FusedLimit{});
  if (is_done || context_.sink.has_errors() || !struts_fit(thickness, 0.4, context)) return {};
  options_.run.report("realise", context.done);  // why it is no lattice is for before the minutes that it may now take
  std::string why_no_graph;
  if (may_be_graph) {
    GraphStep of_graph = apply_graph(state.solids, *cells, context, state.counts);
    if (of_graph.step && misses(*of_graph.step, state, part, *cells, apply)) return {};
    if (of_graph.step || context_.sink.has_errors()) return std::move(of_graph.step);
    why_no_graph = std::move(of_graph.why_not);
    if (differ && (cells->lattice_of_places() || pattern->mapping == CellMapping::conformal)) {
      if (of_graph.may_be_fused)
        is_done = try_template(state, part, *cells, context, stays_body, *of_graph.may_be_fused);
      if (is_done || context_.sink.has_errors() || !may_take_booleans(of_graph.may_be_joined, why_no_graph, context))
        return {};
    }
  }
  const bool is_union = apply.operation == ApplyOperation::union_ && state.solids.empty();
  auto made = is_union ? apply_beams(state, *cells, context) : std::nullopt;
  if (context_.sink.has_errors()) return {};
  if (!made) {
    StepTelling telling(*cells, context, !state.solids.empty());
    if (!why_no_graph.empty()) telling.add_reason("nor do the beams meet the body as one: " + why_no_graph);
    made = apply_cells(state.solids, *cells, telling.context(), state.counts);
    telling.pass_on();
  }
  if (made && misses(*made, state, part, *cells, apply)) return {};
  return made;
}

/// Told as an error: cells at records of a field none of which comes near the body.
bool PartFold::misses(const FoldStep& step, const FoldedPart& state, const Part& part, const eval::CellStream& cells,
                      const Apply& apply) {
  if (step.reaches || state.solids.empty() || !eval::must_reach(cells, apply)) return false;
  eval::report_no_reach(evaluation_, cells, part, context_.sink);
  return true;
}

/// Ways that need no booleans of all cells. Steps and parts that go on from the result need solids: cells that keep
/// apart are had faster as what they are.
bool PartFold::try_template(FoldedPart& state, const Part& part, const eval::CellStream& cells,
                            const FoldContext& context, bool stays_body, const FusedLimit& fused) {
  FoldedPart made = state;
  const auto mesh = stays_body ? fineness(options_) : std::nullopt;
  const bool is_union = context.apply.operation == ApplyOperation::union_ && state.solids.empty();
  const bool may_be_graph = is_union && may_be_beam_graph(cells, context_);
  const bool graph_first = may_be_graph && graph_comes_first(cells);
  bool is_made = graph_first && try_beam_graph(made, cells, context, mesh);
  if (context_.sink.has_errors()) return false;
  if (!is_made && may_be_lattice(context.apply, state.solids))
    is_made = try_lattice(made, cells, context, part.id.text, {mesh, fused});
  if (context_.sink.has_errors()) return false;
  if (!is_made && may_be_graph && !graph_first) is_made = try_beam_graph(made, cells, context, mesh);
  if (context_.sink.has_errors() || !is_made) return false;
  return take(state, std::move(made), stays_body);
}

bool PartFold::take(FoldedPart& state, FoldedPart made, bool stays_body) {
  if (!stays_body) {
    if (2 * made.body->solids.size() > made.counts.kept - state.counts.kept) return false;
    auto solids = solids_from(*made.body, Edges::mended);
    if (!solids) return false;
    made.solids = std::move(*solids);
    made.body.reset();
  }
  state = std::move(made);
  return true;
}

bool PartFold::try_beams(FoldedPart& state, const Part& part, bool stays_body) {
  const eval::BeamsShape* beams = beams_of(part);
  if (beams == nullptr) return false;
  auto graph = beam_graph_part(*beams, part.id_in_source,
                               {stays_body ? fineness(options_) : std::nullopt, options_.run}, context_);
  if (!graph) return false;
  return take(state, {.body = std::move(graph->body), .counts = counts_inside(part), .way = "beamGraph"}, stays_body);
}

bool PartFold::try_lattice(FoldedPart& state, const eval::CellStream& cells, const FoldContext& context,
                           const std::string& part, const LatticeWay& way) {
  const Apply& apply = context.apply;
  if (cells.size() > options_.run.max_cells) return false;
  std::optional<CellRule> whole_cells;
  if (const auto rule = apply.boundary.value_or(BoundaryRule::clip); rule != BoundaryRule::clip)
    whole_cells = CellRule{rule, apply.test.value_or(InsideTest::box), context.clearance};
  StepTelling telling(cells, context, !state.solids.empty());
  auto lattice = lattice_part({.clip = state.solids, .whole_cells = whole_cells, .mesh = way.mesh, .fused = way.fused},
                              cells, telling.context().solid);
  telling.pass_on();
  if (!lattice) return false;
  state.counts.placed += cells.size();
  state.counts.kept += lattice->kept;
  state.counts.crossing += lattice->crossing;
  state.clip = std::move(lattice->clip);
  // A union has no fragments; of each solid of a cut body that anything is left of, one piece is that solid.
  const std::size_t cut = whole_cells || state.solids.empty() ? 0 : solids_cut(lattice->body, state.solids);
  lattice->body.fragments = cut == 0 ? 0 : lattice->body.solids.size() - cut;
  state.counts.fragments += lattice->body.fragments;
  if (lattice->body.fragments > 0) {
    const FragmentRule rule = apply.fragments.value_or(FragmentRule::keep);
    if (rule == FragmentRule::drop) {
      keep_largest(lattice->body);
      state.counts.dropped += lattice->body.fragments;
    }
    if (rule == FragmentRule::error) {
      context_.report(Code::geometry_fragments, apply.id_in_source, {part, std::to_string(lattice->body.fragments)});
      return false;
    }
  }
  state.body = std::move(lattice->body);
  state.way = "lattice";
  return true;
}

bool PartFold::try_joined(FoldedPart& state, const Part& part, std::size_t at) {
  const Apply& pattern_step = part.steps[at];
  const Pattern* pattern = evaluation_.find_pattern(pattern_step.pattern->text);
  const auto cells = pattern != nullptr ? evaluation_.cells(*pattern, context_.sink) : std::nullopt;
  if (!cells || cells->size() > options_.run.max_cells || !cells->lattice() || cells->shape_varies()) return false;
  if (const Thickness thickness = strut_thickness(*cells, context_.sink); thickness.ratio() > 0.5 || thickness.is_block)
    return false;
  if (!eval::check_reach(evaluation_, *cells, pattern_step, part, box_of_all(state.solids), {}, context_.sink))
    return false;
  CellCounts counts = state.counts;
  std::vector<BodyStep> rest;
  for (std::size_t i = at + 1; i < part.steps.size(); ++i) {
    auto operand = placed_operand(part.steps[i], counts);
    if (!operand) return false;
    rest.push_back({&part.steps[i], std::move(*operand)});
  }
  const FoldContext context{context_, pattern_step, 0, options_.max_boolean_solids};
  StepTelling telling(*cells, context, true);
  auto made = joined_lattice(state.solids, pattern_step, *cells, rest, fineness(options_), telling.context());
  // The usual way tells again what is wrong with the bodies.
  telling.pass_on([&](const Diagnostic& d) { return made || d.code == Code::geometry_not_repeatable; });
  if (!made) return false;
  if (const Part* inner = part_in_cells(*pattern)) counts = sum_of(counts, counts_inside(*inner));
  counts.placed += cells->size();
  counts.kept += made->part.kept;
  counts.crossing += made->part.crossing;
  counts.fragments += made->fragments;
  state.counts = counts;
  state.clip = std::move(made->part.clip);
  state.body = std::move(made->part.body);
  state.way = "lattice";
  return true;
}

bool PartFold::try_beam_graph(FoldedPart& state, const eval::CellStream& cells, const FoldContext& context,
                              const std::optional<MeshFineness>& mesh) {
  if (cells.size() > options_.run.max_cells) return false;
  auto graph = beam_graph_part(cells, context.where(), {mesh, options_.run}, context_);
  if (!graph) return false;
  state.counts.placed += cells.size();
  state.counts.kept += graph->kept;
  state.body = std::move(graph->body);
  state.way = "beamGraph";
  return true;
}

/// Beams that cells share are joined once. Nothing, and no error, where the cells are to be joined as they are.
std::optional<FoldStep> PartFold::apply_beams(FoldedPart& state, const eval::CellStream& cells,
                                              const FoldContext& context) {
  if (!may_be_beam_graph(cells, context_) || cells.size() > options_.run.max_cells) return {};
  const auto primitives = beam_graph_primitives(cells, context_);
  if (!primitives) return {};
  auto made = apply_solids({}, *primitives, context);
  if (!made) return {};
  state.counts.placed += cells.size();
  state.counts.kept += cells.size();
  return made;
}

std::optional<FoldStep> PartFold::apply_part(FoldedPart& state, const FoldContext& context) {
  const auto solids = placed_operand(context.apply, state.counts);
  return solids ? apply_solids(state.solids, *solids, context) : std::nullopt;
}

std::optional<Solids> PartFold::placed_operand(const Apply& apply, CellCounts& counts) {
  const Part* part = evaluation_.find_part(apply.part->text);
  const auto placement = evaluation_.placement(apply.placement, context_.sink);
  const Operand* operand = part != nullptr && placement ? operand_of(*part) : nullptr;
  if (operand == nullptr) return {};
  counts = sum_of(counts, without_fragments(operand->counts));
  Solids solids = operand->solids;
  for (TopoDS_Shape& solid : solids) solid = mapped(solid, *placement);
  return solids;
}

const PartFold::Operand* PartFold::operand_of(const Part& part) {
  if (const auto known = operands_.find(&part); known != operands_.end()) return &known->second;
  auto folded = fold(part, false);
  if (!folded) return nullptr;
  return &operands_.emplace(&part, Operand{std::move(folded->solids), folded->counts}).first->second;
}

const Solids* PartFold::solids_of(const Part& part) {
  const Operand* operand = operand_of(part);
  return operand != nullptr ? &operand->solids : nullptr;
}

}  // namespace meso::brep
