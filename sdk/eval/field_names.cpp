// SPDX-License-Identifier: Apache-2.0
#include "field_names.hpp"

#include "meso/model/walk.hpp"

namespace meso::eval {
namespace {

void add_names(std::string_view text, std::set<std::string>& names) {
  const expr::ParseResult parsed = expr::parse_expression(text, LengthUnit::millimeter);
  if (!parsed.expression) return;  // reported where it is bound
  for (const expr::Name& name : parsed.expression->names()) {
    if (name.text.find('.') != std::string::npos) names.insert(name.text);
  }
}

}  // namespace

std::set<std::string> named_quantities(const Pattern& pattern, const UnitCell& cell) {
  std::set<std::string> names;
  const auto add = [&names](const Element&, std::string_view, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Expression>) add_names(value.text, names);
    if constexpr (std::is_same_v<Value, ExpressionList>)
      for (const expr::ListItem& item : expr::split_list(value.text)) add_names(item.text, names);
  };
  walk(pattern, add);
  for (const CellParameter& parameter : cell.parameters) walk(parameter, add);
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
