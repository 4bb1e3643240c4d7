// SPDX-License-Identifier: Apache-2.0
#include "instructions.hpp"

#include <algorithm>
#include <type_traits>

#include "meso/model/walk.hpp"

namespace meso {
namespace {

class InstructionCheck {
 public:
  InstructionCheck(Context& c, const UnitCell* cell, Scope& names)
      : c_(c), cell_(cell), names_(names), point_(&c.parameters) {
    for (const char* name : {"global.x", "global.y", "global.z"}) point_.add(name, "the point's place");
  }

  void operator()(const SetInstruction& e) {
    const bool is_cell = e.at.value_or(SetAt::cell) == SetAt::cell;
    const bool good = c_.check(e, "value", e.value, is_cell ? names_ : point_);
    if (cell_ == nullptr) return;
    const auto& parameters = cell_->parameters;
    const auto found =
        std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == e.parameter; });
    if (found == parameters.end())
      report_unknown(e);
    else if (good)
      check_bounds(c_, e, "value", e.value, found->name.text, found->min, found->max);
    check_at(e);
  }
  void operator()(const OrientInstruction& e) {
    walk(e, ExpressionCheck{c_, names_});
    if (e.zero.value_or(ZeroVectorRule::error) == ZeroVectorRule::error && c_.is_zero(e.x, e.y, e.z))
      c_.report(Code::direction_zero, e, "", {});
    if (e.second && e.second->axis == e.axis)
      c_.report(Code::orient_same_axis, *e.second, "axis",
                {std::string(enum_texts<CellAxis>[static_cast<std::size_t>(e.axis)])});
  }
  void operator()(const RotateInstruction& e) {
    walk(e, ExpressionCheck{c_, names_});
    if (c_.is_zero(e.x, e.y, e.z)) c_.report(Code::direction_zero, e, "", {});
  }
  void operator()(const ScaleInstruction& e) {
    walk(e, ExpressionCheck{c_, names_});
    check_scale(c_, e, e.x, e.y, e.z, e.factor);
  }
  void operator()(const TranslateInstruction& e) { walk(e, ExpressionCheck{c_, names_}); }
  void operator()(const WhenInstruction& e) { walk(e, ExpressionCheck{c_, names_}); }
  void operator()(const SampleInstruction& e) {
    walk(e, ExpressionCheck{c_, names_});
    const int components = (e.x ? 1 : 0) + (e.y ? 1 : 0) + (e.z ? 1 : 0);
    if (components != 0 && components != 3)
      c_.report(Code::attribute_needed, e, "", {"x, y or z", "beside the others: a point has all three"});
    const VectorField* field = c_.find(e.field);
    if (field == nullptr) {
      names_.open();
      point_.open();
      return;
    }
    const bool is_records = !field->interpolation || field->interpolation->method == InterpolationMethod::records;
    if (field->structure && is_records)
      c_.report(Code::field_interpolation, e, "field", {"the field '" + field->id.text + "'", "records"});
    sample_components(*field);
  }

 private:
  void sample_components(const VectorField& field) {
    for (const std::string& component : component_names(field)) {
      names_.add(field.id.text + "." + component, "a component");
      point_.add(field.id.text + "." + component, "a component");
    }
  }
  void report_unknown(const SetInstruction& e) {
    std::vector<std::string_view> candidates;
    for (const CellParameter& p : cell_->parameters) candidates.push_back(p.name.text);
    c_.report(Code::link_unknown_parameter, e, "parameter",
              {cell_->id.text, e.parameter.text, c_.suggestion_or_list(e.parameter.text, candidates, "parameters")});
  }
  ///
  void check_at(const SetInstruction& e) {
    const SetAt at = e.at.value_or(SetAt::cell);
    const bool has_body = !std::holds_alternative<std::monostate>(cell_->body);
    const bool wrong_node = at == SetAt::node && !std::holds_alternative<BeamsBody>(cell_->body);
    const bool wrong_point = at == SetAt::point && !std::holds_alternative<ImplicitBody>(cell_->body);
    if (!has_body || (!wrong_node && !wrong_point)) return;
    const std::string found = std::visit(
        [](const auto& body) -> std::string {
          if constexpr (std::is_base_of_v<Element, std::decay_t<decltype(body)>>)
            return "<" + std::string(element_name<std::decay_t<decltype(body)>>) + ">";
          return {};
        },
        cell_->body);
    c_.report(Code::set_at_body, e, "at",
              {wrong_node ? "node" : "point", wrong_node ? "beams" : "implicit", cell_->id.text, found});
  }

  Context& c_;
  const UnitCell* cell_;
  Scope& names_;
  Scope point_;  ///< what at="node" and at="point" see: the same at a shared node from both its cells
};

}  // namespace

void check_instructions(Context& c, const Pattern& pattern, const UnitCell* cell, Scope& names) {
  InstructionCheck check(c, cell, names);
  for (const Instruction& instruction : pattern.instructions) std::visit(check, instruction);
}

void check_conformal_instruction(Context& c, const Instruction& instruction) {
  std::visit(
      [&](const auto& e) {
        using T = std::decay_t<decltype(e)>;
        constexpr bool is_allowed = std::is_same_v<T, SetInstruction> || std::is_same_v<T, SampleInstruction> ||
                                    std::is_same_v<T, WhenInstruction>;
        if (!is_allowed) c.report(Code::conformal_instruction, e, "", {std::string(element_name<T>)});
      },
      instruction);
}

}  // namespace meso
