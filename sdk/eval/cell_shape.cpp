// SPDX-License-Identifier: Apache-2.0
// The body of a placed cell.
#include "beams.hpp"
#include "cell_stream_impl.hpp"
#include "conformal.hpp"
#include "walker.hpp"

namespace meso::eval {
namespace {

/// Slots as the walker had them at this cell, in the document's unit.
std::vector<double> slots_of(const PatternProgram& program, const PlacedCell& cell) {
  std::vector<double> slots = program.slots;
  const auto copy = [&](std::size_t slot, const auto& values) {
    for (std::size_t i = 0; i < values.size(); ++i) slots[slot + i] = static_cast<double>(values[i]);
  };
  copy(program.parameter_slot, cell.parameters);
  copy(program.index_slot, cell.index);
  const double scale = program.evaluation->millimeters();
  for (std::size_t a = 0; a < cell.q.size(); ++a) {
    const AxisKind kind = program.frame->axes()[a].kind;
    const bool is_length = kind == AxisKind::linear || kind == AxisKind::distance;
    slots[program.axis_slot + a] = is_length ? cell.q[a] / scale : cell.q[a];
  }
  for (std::size_t i = 0; i < 3; ++i) slots[program.global_slot + i] = cell.global[i] / scale;
  if (!program.loops.empty() && program.loops[0].scatter) {
    const ScatterRecords& scatter = *program.loops[0].scatter;
    DiagnosticSink unused;  // the walker has had the same values
    (void)scatter.source->at_record(static_cast<std::size_t>(cell.index[0]), scatter.quantities, slots,
                                    program.loops[0].place, program.evaluation->report(unused));
  }
  return slots;
}

Report report_at(const CellStream::Impl& impl, const PlacedCell& cell, DiagnosticSink& sink) {
  Report report = impl.data().report(sink);
  report.related.push_back(
      {report.source.span(impl.program->pattern->id_in_source), impl.program->cell_name(cell.index)});
  return report;
}

bool has_automatic_balls(const UnitCell& cell) {
  const auto* beams = std::get_if<BeamsBody>(&cell.body);
  return beams != nullptr && beams->node_radius && beams->node_radius->text == "auto";
}

/// node sets see the place where the node ends up.
NodeRules node_rules(const CellStream::Impl& impl, const PlacedCell& cell, const std::vector<double>& slots,
                     const std::optional<BoxShape>& box, const Report& report) {
  const PatternProgram& program = *impl.program;
  const double scale = impl.data().millimeters();
  NodeRules rules{.period = box};
  if (impl.is_conformal())
    rules.position = [&, scale](Vec3 p) { return map_point(*impl.frame_mm, cell, *box, scale * p) / scale; };
  if (program.node_statements.empty()) return rules;
  rules.slots = [&, scale](Vec3 placed, std::vector<double>& own) {
    own = slots;
    const Vec3 global = impl.is_conformal() ? placed : (cell.world_from_cell * (scale * placed)) / scale;
    for (std::size_t i = 0; i < 3; ++i) own[program.node_global_slot + i] = global[i];
    for (const auto& statement : program.node_statements) {
      if (const auto* sample = std::get_if<Sample>(&statement)) {
        if (!sample->source->at_point(global, sample->quantities, own, sample->place, report)) return false;
        continue;
      }
      const auto& assign = std::get<Assign>(statement);
      const auto value = eval::evaluate(assign.expression, own, report);
      if (!value) return false;
      own[assign.slot] = *value;
    }
    return true;
  };
  return rules;
}

void make_pole_balls(const CellStream::Impl& impl, LazyPoleBalls& out) {
  DiagnosticSink sink;
  const UnitCell& cell = *impl.program->cell;
  PoleBalls poles;
  const auto add = [&](const PlacedCell& placed) {
    const Report report = report_at(impl, placed, sink);
    const std::vector<double> slots = slots_of(*impl.program, placed);
    const auto box = make_box(impl.data(), impl.body, *cell.box, slots, report);
    return box && append_pole_struts(impl.data(), impl.body, std::get<BeamsBody>(cell.body), slots, report,
                                     node_rules(impl, placed, slots, box, report), poles);
  };
  if (Walker(*impl.program, sink).visit(0, impl.size, add) && !sink.has_errors()) {
    poles.measure();
    out.balls = std::move(poles);
  }
  out.told = sink.diagnostics();
}

/// Null if they cannot be made, which is reported.
const PoleBalls* pole_balls(const CellStream::Impl& impl, DiagnosticSink& sink) {
  std::call_once(impl.poles.once, [&] { make_pole_balls(impl, impl.poles); });
  if (impl.poles.balls) return &*impl.poles.balls;
  for (const Diagnostic& d : impl.poles.told) sink.report(d);
  return nullptr;
}

}  // namespace

bool CellStream::shape_varies() const { return impl_->is_conformal() || !impl_->program->node_statements.empty(); }

std::optional<BoxShape> CellStream::cell_box(const PlacedCell& cell, DiagnosticSink& sink) const {
  const auto& box = impl_->program->cell->box;
  if (!box) return std::nullopt;
  const std::vector<double> slots = slots_of(*impl_->program, cell);
  return make_box(impl_->data(), impl_->body, *box, slots, report_at(*impl_, cell, sink));
}

std::optional<Shape> CellStream::cell_region(const PlacedCell& cell, DiagnosticSink& sink) const {
  const auto box = cell_box(cell, sink);
  if (!box) return std::nullopt;
  const Shape shape{*box, impl_->program->cell->box->id_in_source};
  if (!impl_->is_conformal()) return shape;
  return map_shape(impl_->frame_mm, cell, *box, shape, report_at(*impl_, cell, sink));
}

std::optional<Shape> CellStream::shape(const PlacedCell& cell, DiagnosticSink& sink) const {
  const PatternProgram& program = *impl_->program;
  const Report report = report_at(*impl_, cell, sink);
  if (program.sets_points) {
    report(Code::not_yet_evaluated, {program.pattern->id_in_source, {}},
           {"set at=\"point\" outside of the implicit engine"});
    return std::nullopt;
  }
  const std::vector<double> slots = slots_of(program, cell);
  if (impl_->is_conformal() && !program.cell->box) {
    report(Code::box_needed, {program.cell->id_in_source, {}}, {program.cell->id.text, "conformal mapping bends it"});
    return std::nullopt;
  }
  std::optional<BoxShape> box;
  if (program.cell->box && (impl_->is_conformal() || has_automatic_balls(*program.cell))) {
    box = make_box(impl_->data(), impl_->body, *program.cell->box, slots, report);
    if (!box) return std::nullopt;
  }
  NodeRules rules = node_rules(*impl_, cell, slots, box, report);
  rules.poles = [&] { return pole_balls(*impl_, sink); };
  auto shape = make_shape(impl_->data(), impl_->body, *program.cell, slots, report, rules);
  if (!shape || !impl_->is_conformal() || std::holds_alternative<BeamsShape>(shape->value)) return shape;
  return map_shape(impl_->frame_mm, cell, *box, *shape, report);
}

}  // namespace meso::eval
