// SPDX-License-Identifier: Apache-2.0
#include "field_names.hpp"

#include "meso/model/describe.hpp"

namespace meso::eval {
namespace {

/// Visits every expression of an element and of those in it.
class NameCollector {
 public:
  NameCollector(LengthUnit unit, std::set<std::string>& names) : unit_(unit), names_(names) {}

  void attribute(std::string_view, const Expression& value) { add(value.text); }
  void attribute(std::string_view, const std::optional<Expression>& value) {
    if (value) add(value->text);
  }
  void attribute(std::string_view, const ExpressionList& value) {
    for (const expr::ListItem& item : expr::split_list(value.text)) add(item.text);
  }
  template <class T>
  void attribute(std::string_view, const T&) {}
  void text(const std::string&) {}
  template <class T>
  void child(std::string_view, const T& element) {
    describe(*this, element);
  }
  template <class T>
  void child(std::string_view, const std::optional<T>& element) {
    if (element) describe(*this, *element);
  }
  template <class T>
  void children(std::string_view, const std::vector<T>& elements) {
    for (const T& e : elements) describe(*this, e);
  }
  void sequence(const std::vector<Instruction>& elements) {
    for (const Instruction& e : elements) choice(e);
  }
  template <class... T>
  void choice(const std::variant<T...>& value) {
    std::visit(
        [this](const auto& v) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(v)>, std::monostate>) describe(*this, v);
        },
        value);
  }

 private:
  void add(std::string_view text) {
    const expr::ParseResult parsed = expr::parse_expression(text, unit_);
    if (!parsed.expression) return;  // reported where it is bound
    for (const expr::Name& name : parsed.expression->names()) {
      if (name.text.find('.') != std::string::npos) names_.insert(name.text);
    }
  }
  LengthUnit unit_;
  std::set<std::string>& names_;
};

}  // namespace

std::set<std::string> named_quantities(const Pattern& pattern, const UnitCell& cell) {
  std::set<std::string> names;
  NameCollector collector(LengthUnit::millimeter, names);
  describe(collector, pattern);
  for (const CellParameter& parameter : cell.parameters) describe(collector, parameter);
  return names;
}

std::vector<QuantitySlot> define_quantities(PatternProgram& program, Scope& scope, const VectorField& field,
                                            int level) {
  std::vector<QuantitySlot> result;
  for (FieldQuantity& quantity : field_quantities(field)) {
    const std::string name = field.id.text + "." + quantity.name;
    if (!program.named_quantities.contains(name)) continue;
    const std::uint32_t slot = program.add_slots(1, 0);
    scope.define(name, slot, level);
    result.push_back({std::move(quantity), slot});
  }
  return result;
}

}  // namespace meso::eval
