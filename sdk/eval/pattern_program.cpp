// SPDX-License-Identifier: Apache-2.0
// Statements of a pattern: defaults of the cell's parameters, then the instructions. Loops are in generator.cpp.
#include "pattern_program.hpp"

#include <algorithm>

#include "field_names.hpp"
#include "generator.hpp"

namespace meso::eval {
namespace {

/// One value for a cell parameter, in the order in which values are given.
struct Write {
  std::size_t parameter;
  const Expression* value;
  Place place;
};
using Operation = std::variant<Write, const OrientInstruction*, const RotateInstruction*, const ScaleInstruction*,
                               const TranslateInstruction*, const SampleInstruction*, const WhenInstruction*>;

class StatementCompiler {
 public:
  StatementCompiler(PatternProgram& program, Scope& scope, const Report& report)
      : program_(program), scope_(scope), report_(report) {}

  bool compile() {
    if (!read_dependencies()) return false;
    std::vector<Operation> operations;
    if (!list_operations(operations)) return false;
    std::vector<std::size_t> writes_left(program_.cell->parameters.size(), 0);
    for (const Operation& o : operations) {
      if (const auto* write = std::get_if<Write>(&o)) ++writes_left[write->parameter];
    }
    for (const Operation& o : operations) {
      const auto* write = std::get_if<Write>(&o);
      const bool good = write != nullptr ? add_write(*write, --writes_left[write->parameter] == 0)
                                         : std::visit([&](const auto& i) { return add(i); }, o);
      if (!good) return false;
    }
    return compile_node_sets();
  }

 private:
  const std::vector<CellParameter>& parameters() const { return program_.cell->parameters; }
  LengthUnit unit() const { return program_.evaluation->unit(); }

  std::size_t parameter_position(const Name& name) const {
    const auto& all = parameters();
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [&](const CellParameter& p) { return p.name == name; }) - all.begin());
  }

  bool read_dependencies() {
    for (const CellParameter& p : parameters()) {
      const expr::ParseResult parsed = expr::parse_expression(p.value.text, unit());
      std::vector<std::size_t>& uses = uses_.emplace_back();
      if (!parsed.expression) continue;  // reported when it is bound
      for (const expr::Name& name : parsed.expression->names()) {
        const std::size_t used = parameter_position(Name{name.text});
        if (used < parameters().size()) uses.push_back(used);
      }
    }
    return true;
  }

  /// the defaults that follow from a parameter which has just been given a value.
  std::vector<std::size_t> followers(std::size_t changed, const std::vector<bool>& is_set) const {
    std::vector<bool> moved(parameters().size(), false);
    moved[changed] = true;
    std::vector<std::size_t> result;
    for (std::size_t p = changed + 1; p < parameters().size(); ++p) {
      if (is_set[p] || std::none_of(uses_[p].begin(), uses_[p].end(), [&](std::size_t u) { return moved[u]; }))
        continue;
      moved[p] = true;
      result.push_back(p);
    }
    return result;
  }

  Write default_of(std::size_t p) const { return {p, &parameters()[p].value, {parameters()[p].id_in_source, "value"}}; }

  bool list_operations(std::vector<Operation>& operations) {
    is_set_.assign(parameters().size(), false);
    for (std::size_t p = 0; p < parameters().size(); ++p) operations.emplace_back(default_of(p));
    for (const Instruction& instruction : program_.pattern->instructions) {
      if (const auto* set = std::get_if<SetInstruction>(&instruction)) {
        if (set->at.value_or(SetAt::cell) == SetAt::point) program_.sets_points = true;
        if (set->at.value_or(SetAt::cell) == SetAt::node) node_sets_.push_back(set);
        if (set->at.value_or(SetAt::cell) != SetAt::cell) continue;
        const std::size_t p = parameter_position(set->parameter);
        operations.emplace_back(Write{p, &set->value, {set->id_in_source, "value"}});
        is_set_[p] = true;
        for (const std::size_t f : followers(p, is_set_)) operations.emplace_back(default_of(f));
      } else {
        std::visit(
            [&](const auto& i) {
              using T = std::decay_t<decltype(i)>;
              if constexpr (!std::is_same_v<T, SetInstruction>) operations.emplace_back(&i);
            },
            instruction);
      }
    }
    return true;
  }

  std::uint32_t new_slots(std::size_t count, double value) { return program_.add_slots(count, value); }
  std::uint32_t parameter_slot(std::size_t p) const { return static_cast<std::uint32_t>(program_.parameter_slot + p); }

  // A statement behind one that may drop the cell must run again whenever that one may decide otherwise.
  void add_statement(int level, decltype(Statement::action) action) {
    program_.statements.push_back({std::max(level, floor_), std::move(action)});
  }

  /// Level of the value, or nothing if something was reported.
  std::optional<int> assign(std::string_view text, const Place& place, std::uint32_t slot) {
    auto bound = scope_.bind(text, place, unit(), report_);
    if (!bound) return std::nullopt;
    const int level = std::max(bound->level, floor_);
    add_statement(level, Assign{std::move(*bound), slot});
    return level;
  }
  bool assign(const Element& element, std::string_view attribute, const std::optional<Expression>& value,
              std::uint32_t slot, int& level) {
    if (!value) return true;
    const auto own = assign(value->text, {element.id_in_source, attribute}, slot);
    if (own) level = std::max(level, *own);
    return own.has_value();
  }
  template <class E>
  std::optional<std::uint32_t> vector(const E& e, double otherwise, int& level) {
    const std::uint32_t slot = new_slots(3, otherwise);
    if (!assign(e, "x", e.x, slot, level) || !assign(e, "y", e.y, slot + 1, level) ||
        !assign(e, "z", e.z, slot + 2, level))
      return std::nullopt;
    return slot;
  }

  bool add_write(const Write& write, bool is_last) {
    const CellParameter& parameter = parameters()[write.parameter];
    const std::uint32_t slot = is_last ? parameter_slot(write.parameter) : new_slots(1, 0);
    auto level = assign(write.value->text, write.place, slot);
    if (!level) return false;
    for (const bool upper : {false, true}) {
      const std::optional<Expression>& limit = upper ? parameter.max : parameter.min;
      if (!limit) continue;
      const std::uint32_t limit_slot = new_slots(1, 0);
      const auto limit_level = assign(limit->text, {parameter.id_in_source, upper ? "max" : "min"}, limit_slot);
      if (!limit_level) return false;
      add_statement(std::max(*level, *limit_level), Bound{&parameter, write.place, slot, limit_slot, upper});
    }
    scope_.define(parameter.name.text, slot, *level);
    return true;
  }

  bool add(const Write&) { return false; }
  bool add(const OrientInstruction* o) {
    int level = constant_level;
    const auto vector_slot = vector(*o, 0, level);
    if (!vector_slot) return false;
    std::uint32_t second_slot = 0;
    if (o->second) {
      const auto slot = vector(*o->second, 0, level);
      if (!slot) return false;
      second_slot = *slot;
    }
    // Global components are seen from the frame of the moment, which turns with circular coordinates too.
    if (o->frame.value_or(VectorFrame::cell) == VectorFrame::global)
      level = std::max({level, frame_level_, program_.turn_level});
    add_move(level, Orient{o, *vector_slot, second_slot});
    if (o->zero.value_or(ZeroVectorRule::error) == ZeroVectorRule::drop) drop_from(level);
    return true;
  }
  bool add(const RotateInstruction* r) {
    int level = constant_level;
    const auto axis = vector(*r, 0, level);
    const std::uint32_t angle = new_slots(1, 0);
    if (!axis || !assign(*r, "angle", r->angle, angle, level)) return false;
    add_move(level, Rotate{r, *axis, angle});
    return true;
  }
  bool add(const ScaleInstruction* s) {
    int level = constant_level;
    auto factors = s->factor ? std::optional(new_slots(3, 1)) : vector(*s, 1, level);
    if (!factors) return false;
    for (std::uint32_t i = 0; s->factor && i < 3; ++i) {
      if (!assign(*s, "factor", s->factor, *factors + i, level)) return false;
    }
    add_move(level, Scale{s, *factors});
    return true;
  }
  bool add(const TranslateInstruction* t) {
    int level = constant_level;
    const auto offset = vector(*t, 0, level);
    if (!offset) return false;
    add_move(level, Translate{*offset});
    return true;
  }
  bool add(const SampleInstruction* s) {
    const auto& all = program_.evaluation->document().vector_fields;
    const VectorField& field =
        *std::find_if(all.begin(), all.end(), [&](const VectorField& f) { return f.id.text == s->field.text; });
    Sample sample{program_.evaluation->fields->find(*program_.evaluation, field, true, report_),
                  {s->id_in_source, "field"},
                  static_cast<std::uint32_t>(program_.global_slot),
                  {}};
    if (!sample.source) return false;
    int level = constant_level;
    if (s->x) {
      const auto point = vector(*s, 0, level);
      if (!point) return false;
      sample.point = *point;
    } else {
      level = program_.global_level;
    }
    sample.quantities = define_quantities(program_, scope_, field, std::max(level, floor_));
    sampled_.push_back(sample);
    add_statement(level, std::move(sample));
    return true;
  }
  bool add(const WhenInstruction* w) {
    const std::uint32_t slot = new_slots(1, 0);
    const auto level = assign(w->test.text, {w->id_in_source, "test"}, slot);
    if (!level) return false;
    add_statement(*level, When{slot});
    drop_from(*level);
    return true;
  }

  void add_move(int level, decltype(Statement::action) action) {
    add_statement(level, std::move(action));
    frame_level_ = std::max(frame_level_, program_.statements.back().level);
  }
  void drop_from(int level) {
    program_.drops_cells = true;
    floor_ = std::max(floor_, level);
  }

  /// at a node, sets see document parameters and the node's place; defaults that follow see what they always
  /// see.
  bool compile_node_sets() {
    Scope node_scope = program_.evaluation->scope;
    static constexpr std::string_view names[] = {"global.x", "global.y", "global.z"};
    for (std::uint32_t i = 0; i < 3; ++i)
      node_scope.define(names[i], static_cast<std::uint32_t>(program_.node_global_slot) + i, constant_level);
    for (Sample& sample : sampled_) {
      if (node_sets_.empty()) break;
      // At a node a field is known there, wherever the cell has sampled it.
      sample.point = static_cast<std::uint32_t>(program_.node_global_slot);
      for (const QuantitySlot& q : sample.quantities)
        node_scope.define(sample.source->field().id.text + "." + q.quantity.name, q.slot, constant_level);
      program_.node_statements.push_back(std::move(sample));
    }
    for (const SetInstruction* set : node_sets_) {
      const std::size_t p = parameter_position(set->parameter);
      auto bound = node_scope.bind(set->value.text, {set->id_in_source, "value"}, unit(), report_);
      if (!bound) return false;
      program_.node_statements.push_back(Assign{std::move(*bound), parameter_slot(p)});
      is_set_[p] = true;
      for (const std::size_t f : followers(p, is_set_)) {
        auto follower = scope_.bind(parameters()[f].value.text, default_of(f).place, unit(), report_);
        if (!follower) return false;
        program_.node_statements.push_back(Assign{std::move(*follower), parameter_slot(f)});
      }
    }
    return true;
  }

  PatternProgram& program_;
  Scope& scope_;
  const Report& report_;
  std::vector<std::vector<std::size_t>> uses_;  ///< per parameter: those its default names
  std::vector<bool> is_set_;
  std::vector<const SetInstruction*> node_sets_;
  std::vector<Sample> sampled_;
  int floor_ = constant_level;
  int frame_level_ = constant_level;
};

template <class T>
const T& at_id(const Section<T>& section, std::string_view id) {
  return *std::find_if(section.begin(), section.end(), [&](const T& item) { return item.id.text == id; });
}

void lay_out_slots(PatternProgram& program, std::size_t loops) {
  const std::vector<double>& document = program.evaluation->parameters;
  program.parameter_slot = document.size();
  program.index_slot = program.parameter_slot + program.cell->parameters.size();
  program.axis_slot = program.index_slot + loops;
  program.global_slot = program.axis_slot + program.frame->axes().size();
  program.node_global_slot = program.global_slot + 3;
  program.slots = document;
  program.slots.resize(program.node_global_slot + 3, 0);
}

}  // namespace

std::string PatternProgram::cell_name(std::span<const std::int64_t> index) const {
  std::string text = "in cell (";
  for (std::size_t i = 0; i < index.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(index[i]);
  return text + ") of pattern '" + pattern->id.text + "'";
}

std::shared_ptr<const PatternProgram> compile_pattern(std::shared_ptr<const EvaluationData> evaluation,
                                                      const Pattern& pattern, DiagnosticSink& sink) {
  const Report report = evaluation->report(sink);
  auto program = std::make_shared<PatternProgram>();
  program->pattern = &pattern;
  program->cell = &at_id(evaluation->document().unit_cells, pattern.unit_cell.text);
  program->frame = pattern.coordinate_system ? evaluation->frames.find(pattern.coordinate_system->text)->second
                                             : evaluation->cartesian;
  program->mapping = pattern.mapping.value_or(CellMapping::rigid);
  program->evaluation = std::move(evaluation);
  lay_out_slots(*program, generator_loops(pattern));

  program->named_quantities = named_quantities(pattern, *program->cell);

  Scope scope = program->evaluation->scope;
  if (!compile_generator(*program, scope, report)) return nullptr;
  if (!StatementCompiler(*program, scope, report).compile()) return nullptr;
  return program;
}

}  // namespace meso::eval
