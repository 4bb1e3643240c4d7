// SPDX-License-Identifier: Apache-2.0
// The cell: frame, statements, result. The loops are in walker_loops.cpp.
#include "walker.hpp"

#include <cassert>
#include <cmath>

#include "meso/base/number.hpp"
#include "orientation.hpp"

namespace meso::eval {
namespace {

constexpr std::uint64_t poll_mask = 0xFFF;  // ask for cancellation every 4096 cells: well below a millisecond of work
constexpr std::uint64_t compile_threshold = 1024;
constexpr double distance_tolerance = 1e-9;

}  // namespace

Walker::Walker(const PatternProgram& program, DiagnosticSink& sink)
    : program_(program),
      sink_(sink),
      slots_(program.slots),
      index_(program.loops.size(), 0),
      motions_(program.statements.size()),
      q_(program.frame->axes().size(), 0) {
  for (const LoopProgram& loop : program.loops) state_.push_back(loop.initial);
  cell_.index = index_;
  cell_.mapping = program.mapping;
  cell_.parameters = std::span(slots_).subspan(program.parameter_slot, program.cell->parameters.size());
  cell_.q = q_;
}

Report Walker::report(std::size_t known_indices) const {
  Report report = program_.evaluation->report(sink_);
  const ElementId pattern = program_.pattern->id_in_source;
  report.related.push_back({report.source.span(pattern), program_.cell_name(std::span(index_).first(known_indices))});
  return report;
}

bool Walker::visit(std::uint64_t first, std::uint64_t last, const CellStream::Visitor& visitor) {
  ended_ = false;
  if (first >= last) return true;
  if (last - first > compile_threshold && programs_.empty()) compile();
  if (!seek(first)) return false;
  const RunOptions& run = program_.evaluation->run;
  for (std::uint64_t ordinal = first;;) {
    if ((ordinal & poll_mask) == 0 && run.should_stop()) {
      sink_.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
      return false;
    }
    if (!place()) return false;
    cell_.ordinal = ordinal;
    if (!dropped_ && !visitor(cell_)) {
      ended_ = true;
      return true;
    }
    if (++ordinal == last) return true;
    if (!next()) return false;
  }
}

bool Walker::check_distances() {
  const auto& axes = program_.frame->axes();
  for (std::size_t a = 0; a < axes.size(); ++a) {
    double& q = slots_[program_.axis_slot + a];
    if (axes[a].kind != AxisKind::distance || q >= 0) continue;
    if (q < -distance_tolerance) {
      report(loops())(Code::distance_negative, {program_.pattern->id_in_source, {}}, {axes[a].name, format_number(q)});
      return false;
    }
    q = 0;
  }
  return true;
}

bool Walker::place() {
  const CoordinateFrame& frame = *program_.frame;
  if (!check_distances()) return false;
  const std::span<const double> q = std::span(slots_).subspan(program_.axis_slot, frame.axes().size());
  if (changed_ <= program_.turn_level) {
    turn_ = frame.turn(q);
    local_ = frame.world_from_system().linear * turn_;
  }
  Vec3 offset;
  for (const LoopState& s : state_) offset += s.q * s.direction;
  const Vec3 origin = frame.point(q, turn_, offset);
  for (std::size_t i = 0; i < 3; ++i) slots_[program_.global_slot + i] = origin[i];

  frame_ = {local_, origin};
  dropped_ = false;
  for (std::size_t i = 0; i < program_.statements.size() && !dropped_; ++i) {
    if (!run(program_.statements[i], i)) return false;
  }
  if (program_.mapping == CellMapping::conformal && !dropped_ && !fill_steps()) return false;
  changed_ = static_cast<int>(loops());
  const Vec3 place = frame_.translation;
  if (!std::isfinite(place.x + place.y + place.z)) {
    report(loops())(Code::expression_domain, {program_.pattern->id_in_source, {}}, {"P(q)"});
    return false;
  }

  const double scale = program_.evaluation->millimeters();
  for (std::size_t a = 0; a < q_.size(); ++a) {
    const AxisKind kind = frame.axes()[a].kind;
    q_[a] = kind == AxisKind::linear || kind == AxisKind::distance ? scale * q[a] : q[a];
  }
  cell_.global = scale * origin;
  cell_.world_from_cell = {frame_.linear, scale * frame_.translation};
  return true;
}

// Compiling takes as long as some hundred walks; the values are equal bit for bit.
void Walker::compile() {
  programs_.resize(program_.statements.size());
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    const Statement& statement = program_.statements[i];
    const auto* assign = std::get_if<Assign>(&statement.action);
    if (assign != nullptr && statement.level != constant_level) programs_[i].emplace(assign->expression.expression);
  }
}

bool Walker::assign(const Assign& assign, std::size_t position) {
  double& target = slots_[assign.slot];
  if (programs_.empty() || !programs_[position]) return evaluate(assign.expression, target, loops());
  const expr::EvalResult result = programs_[position]->evaluate(slots_);
  target = result.value;
  // The walk fails in the same place, and says where.
  return result || evaluate(assign.expression, target, loops());
}

bool Walker::run(const Statement& statement, std::size_t position) {
  const bool current = statement.level < changed_;
  if (statement.moves()) {
    Motion& own = motions_[position];
    if (!current && !motion(statement, own)) return false;
    dropped_ = own.drops;
    frame_ = frame_ * own.map;
    return true;
  }
  if (const auto* when = std::get_if<When>(&statement.action)) {
    dropped_ = slots_[when->slot] == 0;
    return true;
  }
  if (current) return true;
  if (const auto* sample = std::get_if<Sample>(&statement.action))
    return sample->source->at_point(vector(sample->point), sample->quantities, slots_, sample->place, report(loops()));
  if (const auto* value = std::get_if<Assign>(&statement.action)) return assign(*value, position);
  const auto& bound = std::get<Bound>(statement.action);
  const double value = slots_[bound.value], limit = slots_[bound.bound];
  if (bound.upper ? value <= limit : value >= limit) return true;
  report(loops())(Code::parameter_range, bound.place,
                  {bound.parameter->name.text, format_number(value),
                   bound.upper ? "greater than its max" : "less than its min", format_number(limit)});
  return false;
}

bool Walker::motion(const Statement& statement, Motion& result) {
  result = {};
  if (const auto* translate = std::get_if<Translate>(&statement.action)) {
    result.map.translation = vector(translate->vector);
    return true;
  }
  if (const auto* scale = std::get_if<Scale>(&statement.action)) {
    const Vec3 factors = vector(scale->factors);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(factors[i] > 0)) {
        static constexpr std::string_view names[] = {"x", "y", "z"};
        const std::string_view name = scale->instruction->factor ? "factor" : names[i];
        report(loops())(Code::value_not_positive, {scale->instruction->id_in_source, name},
                        {std::string(name), format_number(factors[i])});
        return false;
      }
      result.map.linear(i, i) = factors[i];
    }
    return true;
  }
  if (const auto* rotate = std::get_if<Rotate>(&statement.action)) {
    const Vec3 axis = vector(rotate->axis);
    if (norm(axis) == 0) {
      report(loops())(Code::direction_zero, {rotate->instruction->id_in_source, {}}, {});
      return false;
    }
    result.map.linear = rotation(axis / norm(axis), slots_[rotate->angle]);
    return true;
  }
  return orientation(std::get<Orient>(statement.action), result);
}

bool Walker::orientation(const Orient& orient, Motion& result) {
  const OrientInstruction& o = *orient.instruction;
  Vec3 first = vector(orient.vector);
  Vec3 second = o.second ? vector(orient.second) : Vec3{};
  if (o.signless.value_or(false)) {
    first = without_sign(first);
    second = without_sign(second);
  }
  if (o.frame.value_or(VectorFrame::cell) == VectorFrame::global) {
    first = solve(frame_.linear, first);
    second = solve(frame_.linear, second);
  }
  const ZeroVectorRule rule = o.zero.value_or(ZeroVectorRule::error);
  const bool first_zero = norm(first) == 0;
  if (first_zero || (o.second && is_parallel(first, second))) {
    if (rule == ZeroVectorRule::error) {
      report(loops())(Code::direction_zero, {first_zero ? o.id_in_source : o.second->id_in_source, {}}, {});
      return false;
    }
    result.drops = rule == ZeroVectorRule::drop;
    // without its second direction the first still turns the frame.
    if (!first_zero) result.map.linear = smallest_turn(o.axis, first);
    return true;
  }
  result.map.linear = o.second ? two_axis_turn(o.axis, first, o.second->axis, second) : smallest_turn(o.axis, first);
  return true;
}

}  // namespace meso::eval
