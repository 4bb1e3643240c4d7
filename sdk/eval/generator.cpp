// SPDX-License-Identifier: Apache-2.0
#include "generator.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/number.hpp"

namespace meso::eval {
namespace {

constexpr double largest_index = 0x1p53;
constexpr double fill_tolerance = 1e-9;  // in steps

class GeneratorCompiler {
 public:
  GeneratorCompiler(PatternProgram& program, Scope& scope, const Report& report)
      : program_(program), scope_(scope), report_(report), levels_(axes().size(), constant_level) {}

  bool compile() {
    const Pattern& pattern = *program_.pattern;
    if (pattern.scatter && !add(*pattern.scatter)) return false;
    for (const Loop& loop : pattern.loops) {
      if (!add(loop)) return false;
    }
    if (pattern.fill) {
      for (const FillRange& range : pattern.fill->ranges) {
        if (!add(range)) return false;
      }
    }
    if (pattern.list && !add(*pattern.list)) return false;
    define_places();
    return true;
  }

 private:
  const std::vector<CoordinateAxis>& axes() const { return program_.frame->axes(); }
  LengthUnit unit() const { return program_.evaluation->unit(); }
  int level() const { return static_cast<int>(program_.loops.size()); }

  std::uint32_t index_slot() const { return static_cast<std::uint32_t>(program_.index_slot + program_.loops.size()); }

  std::size_t find_axis(const Name& name) const {
    const auto found =
        std::find_if(axes().begin(), axes().end(), [&](const CoordinateAxis& a) { return a.name == name.text; });
    return static_cast<std::size_t>(found - axes().begin());
  }
  std::optional<std::size_t> drive(const Element& element, const Name& name) {
    const std::size_t axis = find_axis(name);
    if (axis == axes().size() || levels_[axis] != constant_level) {
      report_(axis == axes().size() ? Code::link_unknown_axis : Code::axis_twice, {element.id_in_source, "axis"},
              axis == axes().size() ? std::vector<std::string>{"the coordinate system", name.text, ""}
                                    : std::vector<std::string>{name.text});
      return std::nullopt;
    }
    levels_[axis] = level();
    return axis;
  }
  void define_axis(std::size_t axis) {
    scope_.define(axes()[axis].name, static_cast<std::uint32_t>(program_.axis_slot + axis), levels_[axis]);
  }

  bool bind(const Element& element, std::string_view attribute, const Expression& value,
            std::optional<BoundExpression>& bound) const {
    bound = scope_.bind(value.text, {element.id_in_source, attribute}, unit(), report_);
    return bound.has_value();
  }
  bool bind(const Element& element, std::string_view attribute, const std::optional<Expression>& value,
            std::optional<BoundExpression>& bound) const {
    return !value || bind(element, attribute, *value, bound);
  }

  bool bind_direction(const Loop& loop, LoopProgram& program) const {
    if (!loop.x && !loop.y && !loop.z) return true;
    const Expression zero{"0"};
    std::optional<BoundExpression> x, y, z;
    if (!bind(loop, "x", loop.x.value_or(zero), x) || !bind(loop, "y", loop.y.value_or(zero), y) ||
        !bind(loop, "z", loop.z.value_or(zero), z))
      return false;
    program.direction = {std::move(*x), std::move(*y), std::move(*z)};
    return true;
  }

  bool add(const Loop& loop) {
    LoopProgram program;
    program.place = {loop.id_in_source, {}};
    program.index_slot = index_slot();
    if (loop.axis) {
      program.axis = drive(loop, *loop.axis);
      if (!program.axis) return false;
    }
    // Of its own loop, the count, the start and the direction see nothing; spacing and position see the index.
    if (!bind(loop, "count", loop.count, program.count) || !bind(loop, "start", loop.start, program.start) ||
        !bind_direction(loop, program))
      return false;
    scope_.define(loop.index.text, program.index_slot, level());
    if (!bind(loop, "spacing", loop.spacing, program.spacing) ||
        !bind(loop, "position", loop.position, program.position))
      return false;
    if (loop.size && program.axis) {
      Scope along = scope_;
      along.define(loop.axis->text, static_cast<std::uint32_t>(program_.axis_slot + *program.axis), level());
      program.size = along.bind(loop.size->text, {loop.id_in_source, "size"}, unit(), report_);
      if (!program.size) return false;
    }
    program.cumulative = program.size || (program.spacing && program.spacing->names(loop.index.text));
    program.stepped = program.spacing || program.position || program.size;
    if (program.direction) direction_level_ = level();
    program_.loops.push_back(std::move(program));
    return true;
  }

  std::optional<double> constant(const Element& element, std::string_view attribute, const Expression& value) const {
    return program_.evaluation->value(value, {element.id_in_source, attribute}, report_);
  }

  bool add(const FillRange& range) {
    LoopProgram program;
    program.place = {range.id_in_source, {}};
    program.index_slot = index_slot();
    program.axis = drive(range, range.axis);
    if (!program.axis) return false;
    const auto from = constant(range, "from", range.from), to = constant(range, "to", range.to),
               step = constant(range, "step", range.step);
    if (!from || !to || !step) return false;
    if (!(*step > 0)) {
      report_(Code::value_not_positive, {range.id_in_source, "step"}, {"step", format_number(*step)});
      return false;
    }
    const double first = std::ceil(*from / *step - fill_tolerance);
    const double end = std::floor(*to / *step + fill_tolerance);
    if (std::abs(first) > largest_index || std::abs(end) > largest_index) {
      report_(Code::value_not_whole, {range.id_in_source, "step"},
              {"the number of steps", "0", format_number(std::max(std::abs(first), std::abs(end)))});
      return false;
    }
    program.first = static_cast<std::int64_t>(first);
    program.initial.count = std::max<std::int64_t>(0, static_cast<std::int64_t>(end - first));
    program.initial.spacing = *step;
    program.stepped = true;
    if (range.index) scope_.define(range.index->text, program.index_slot, level());
    program_.loops.push_back(std::move(program));
    return true;
  }

  bool add(const Scatter& scatter) {
    LoopProgram program;
    program.place = {scatter.id_in_source, {}};
    program.index_slot = index_slot();
    program.scatter = compile_scatter(program_, scope_, report_);
    if (!program.scatter) return false;
    const ScatterRecords& records = *program.scatter;
    program.initial.count =
        static_cast<std::int64_t>(records.order.empty() ? records.source->records() : records.order.size());
    std::fill(levels_.begin(), levels_.end(), level());
    if (scatter.index) scope_.define(scatter.index->text, program.index_slot, level());
    program_.loops.push_back(std::move(program));
    return true;
  }

  bool add(const PlacementList& list) {
    LoopProgram program;
    program.place = {list.id_in_source, {}};
    program.index_slot = index_slot();
    for (const ListPlace& place : list.places) {
      const std::size_t count = expr::split_list(place.at.text).size();
      auto row =
          program_.evaluation->values(place.at, {place.id_in_source, "at"}, std::min(count, axes().size()), report_);
      if (!row) return false;
      row->resize(axes().size(), 0);
      program.places.push_back(std::move(*row));
    }
    program.initial.count = static_cast<std::int64_t>(program.places.size());
    std::fill(levels_.begin(), levels_.end(), level());
    if (list.index) scope_.define(list.index->text, program.index_slot, level());
    program_.loops.push_back(std::move(program));
    return true;
  }

  void define_places() {
    int global_level = direction_level_;
    for (std::size_t a = 0; a < axes().size(); ++a) {
      define_axis(a);
      global_level = std::max(global_level, levels_[a]);
      if (axes()[a].kind == AxisKind::circular) program_.turn_level = std::max(program_.turn_level, levels_[a]);
    }
    program_.global_level = global_level;
    static constexpr std::string_view names[] = {"global.x", "global.y", "global.z"};
    for (std::uint32_t i = 0; i < 3; ++i)
      scope_.define(names[i], static_cast<std::uint32_t>(program_.global_slot) + i, global_level);
  }

  PatternProgram& program_;
  Scope& scope_;
  const Report& report_;
  std::vector<int> levels_;  ///< per axis
  int direction_level_ = constant_level;
};

}  // namespace

std::size_t generator_loops(const Pattern& pattern) {
  if (pattern.fill) return pattern.fill->ranges.size();
  return pattern.list || pattern.scatter ? 1 : pattern.loops.size();
}

bool compile_generator(PatternProgram& program, Scope& scope, const Report& report) {
  return GeneratorCompiler(program, scope, report).compile();
}

}  // namespace meso::eval
