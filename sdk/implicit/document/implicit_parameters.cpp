// SPDX-License-Identifier: Apache-2.0
// What the names in an implicit cell's expressions mean: numbers, or functions of the point.
#include <algorithm>

#include "implicit_cell.hpp"
#include "meso/base/unit.hpp"
#include "meso/expr/expression.hpp"
#include "point_terms.hpp"

namespace meso::implicit {

std::array<Term, 3> scaled(double factor, const std::array<Term, 3>& p) {
  if (factor == 1) return p;
  return {factor * p[0], factor * p[1], factor * p[2]};
}

std::optional<std::size_t> coordinate(std::string_view name, std::string_view prefix) {
  if (name.size() != prefix.size() + 1 || !name.starts_with(prefix)) return {};
  const char c = name.back();
  return c >= 'x' && c <= 'z' ? std::optional(static_cast<std::size_t>(c - 'x')) : std::nullopt;
}

std::vector<std::string> names_of(const Expression& expression, LengthUnit unit) {
  std::vector<std::string> names;
  if (const auto parsed = expr::parse_expression(expression.text, unit); parsed.expression)
    for (const expr::Name& name : parsed.expression->names()) names.push_back(name.text);
  return names;
}

std::optional<Term> ImplicitCells::term(const Expression& expression, ElementId where, std::string_view attribute,
                                        const Meaning& meaning) const {
  const auto parsed = expr::parse_expression(expression.text, evaluation_.document().unit);
  if (!parsed.expression) return std::nullopt;  // validation has read it
  std::vector<Term> terms;
  for (const expr::Name& name : parsed.expression->names()) {
    auto one = meaning(name.text);
    if (!one) {
      report_(Code::not_yet_evaluated, where, {"the name '" + name.text + "' in " + std::string(attribute)});
      return std::nullopt;
    }
    terms.push_back(std::move(*one));
  }
  return Term::from_expression(*parsed.expression, terms);
}

// for points: sets see document parameters and the point's place; defaults that follow see what they saw in
// the cell.
std::optional<ImplicitCells::Values> ImplicitCells::parameters_at(const eval::PlacedCell& cell, const CellPoint& point,
                                                                  const Box3& region) {
  const auto& parameters = cells_.unit_cell().parameters;
  const auto& instructions = cells_.pattern().instructions;
  const LengthUnit unit = evaluation_.document().unit;
  std::vector<Term> values;
  for (const double v : cell.parameters) values.push_back(Term::constant(v));
  const auto position = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::ranges::find(parameters, name, [](const CellParameter& p) { return p.name.text; }) - parameters.begin());
  };
  std::vector<bool> is_set(parameters.size(), false);
  std::vector<const SetInstruction*> at_points;
  for (const Instruction& instruction : instructions) {
    const auto* set = std::get_if<SetInstruction>(&instruction);
    if (set == nullptr) continue;
    if (set->at.value_or(SetAt::cell) == SetAt::point)
      at_points.push_back(set);
    else
      is_set[position(set->parameter.text)] = true;
  }
  if (at_points.empty()) return values;

  const std::array<Term, 3> place = scaled(1 / unit_mm_, point.global);
  ElementId asking = cells_.pattern().id_in_source;
  const Meaning at_point = [&](const std::string& name) -> std::optional<Term> {
    if (const auto axis = coordinate(name, "global.")) return place[*axis];
    if (name.find('.') != std::string::npos) return quantity(name, asking, point, region);
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  const Meaning in_cell = [&](const std::string& name) -> std::optional<Term> {
    if (const std::size_t p = position(name); p < parameters.size()) return values[p];
    if (const auto axis = coordinate(name, "global.")) return Term::constant(cell.global[*axis] / unit_mm_);
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  for (const SetInstruction* set : at_points) {
    const std::size_t p = position(set->parameter.text);
    asking = set->id_in_source;
    auto value = term(set->value, set->id_in_source, "value", at_point);
    if (!value) return std::nullopt;
    values[p] = std::move(*value);
    is_set[p] = true;
    std::vector<bool> follows(parameters.size(), false);
    follows[p] = true;
    for (std::size_t f = p + 1; f < parameters.size(); ++f) {
      const auto names = names_of(parameters[f].value, unit);
      follows[f] = !is_set[f] && std::ranges::any_of(names, [&](const std::string& name) {
        const std::size_t n = position(name);
        return n < f && follows[n];
      });
      if (!follows[f]) continue;
      value = term(parameters[f].value, parameters[f].id_in_source, "value", in_cell);
      if (!value) return std::nullopt;
      values[f] = std::move(*value);
    }
  }
  return values;
}

std::optional<Term> ImplicitCells::quantity(const std::string& name, ElementId where, const CellPoint& point,
                                            const Box3& region) {
  auto function = evaluation_.quantity(name, where, report_.sink());
  if (!function) return std::nullopt;
  const auto& p = point.global;
  if (!p[0].is_constant()) {
    quantities_.push_back(function);
    return quantity_term(std::move(function), region);
  }
  const auto value = function({p[0].node().number, p[1].node().number, p[2].node().number}, report_.sink());
  return value ? std::optional(Term::constant(*value)) : std::nullopt;
}

std::optional<Term> ImplicitCells::level(const std::optional<Expression>& expression, std::string_view attribute,
                                         const Meaning& meaning) const {
  if (!expression) return Term::constant(0);
  return term(*expression, body_.id_in_source, attribute, meaning);
}

std::shared_ptr<const AxisPhase> ImplicitCells::phase(const Loop& loop, bool is_angle, double from, double to) const {
  const double unit = is_angle ? 1 : unit_mm_;
  const Meaning along = [&](const std::string& name) -> std::optional<Term> {
    if (name == loop.axis->text) return (1 / unit) * Term::coordinate(0);
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  const auto size = term(*loop.size, loop.id_in_source, "size", along);
  const auto start =
      loop.start ? evaluation_.value(*loop.start, loop.id_in_source, "start", report_.sink()) : std::optional(0.0);
  if (!size || !start) return nullptr;
  return std::make_shared<const AxisPhase>(unit * *size, unit * *start, from, to);
}

}  // namespace meso::implicit
