// SPDX-License-Identifier: Apache-2.0
#include "step_telling.hpp"

#include "realise_beam_graph.hpp"

namespace meso::brep {
namespace {

bool is_about_booleans(Code code) {
  return code == Code::geometry_not_repeatable || code == Code::geometry_boolean || code == Code::limit_booleans ||
         code == Code::geometry_struts_meet;
}

/// The pattern's place that moves all its cells.
struct Start {
  ElementId element;
  std::string_view attribute;
};

Start start_of(const Pattern& pattern) {
  if (pattern.loops.empty()) return {pattern.id_in_source, {}};
  return {pattern.loops.front().id_in_source, pattern.loops.front().start ? "start" : ""};
}

}  // namespace

bool would_gain_from_balls(const eval::CellStream& cells, const SolidContext& context) {
  const auto* beams = std::get_if<BeamsBody>(&cells.unit_cell().body);
  if (beams == nullptr || (beams->node_radius && beams->node_radius->text == "auto")) return false;
  DiagnosticSink untold;
  return !struts_part_on_balls(cells, {context.source, context.run, untold, context.parts});
}

Diagnostic StepTelling::placed(Diagnostic d) const {
  if (!is_about_booleans(d.code)) return d;
  const SourceMap& source = of_step_.solid.source;
  const bool is_of_cell = d.code == Code::geometry_boolean && d.path != source.path(of_step_.where());
  if (is_cut_ && (is_of_cell || d.code == Code::geometry_not_repeatable)) {
    if (is_of_cell) d.related.push_back({d.where, "the solids are those of one cell"});
    const Start start = start_of(cells_.pattern());
    d.where = source.span(start.element, start.attribute);
    d.path = source.path(start.element, start.attribute);
  } else if (d.path.empty()) {
    d.where = source.span(of_step_.where());
    d.path = source.path(of_step_.where());
  }
  if (!reason_.empty() && severity(d) == Severity::error) d.related.push_back({d.where, reason_});
  if (would_gain_from_balls(cells_, of_step_.solid)) {
    const ElementId beams = std::get<BeamsBody>(cells_.unit_cell().body).id_in_source;
    d.related.push_back({source.span(beams, "nodeRadius"),
                         "nodeRadius=\"auto\" lets each strut end in a ball; such cells need fewer booleans, or none"});
  }
  return d;
}

void StepTelling::pass_on(const std::function<bool(const Diagnostic&)>& wanted) const {
  for (const Diagnostic& d : apart_.diagnostics())
    if (!wanted || wanted(d)) of_step_.solid.sink.report(placed(d));
}

}  // namespace meso::brep
