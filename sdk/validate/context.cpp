// SPDX-License-Identifier: Apache-2.0
#include "context.hpp"

#include "meso/expr/expression.hpp"
#include "meso/expr/nearest.hpp"

namespace meso {
std::string_view to_text(Kind kind) {
  switch (kind) {
    case Kind::parameter:
      return "parameter";
    case Kind::coordinate_system:
      return "coordinateSystem";
    case Kind::macrostructure:
      return "macrostructure";
    case Kind::unit_cell:
      return "unitCell";
    case Kind::vector_field:
      return "vectorField";
    case Kind::pattern:
      return "pattern";
    case Kind::part:
      return "part";
  }
  return "";
}

std::string Context::suggestion(std::string_view word, std::span<const std::string_view> candidates) const {
  // Comparing words is not cheap, and there may be as many wrong ones as the sink takes.
  constexpr std::size_t most_candidates = 2000;
  if (candidates.size() > most_candidates) return {};
  const std::string_view best = expr::nearest(word, candidates);
  return best.empty() ? std::string() : "; did you mean '" + std::string(best) + "'?";
}

std::string Context::suggestion_or_list(std::string_view word, std::span<const std::string_view> candidates,
                                        std::string_view plural) const {
  std::string text = suggestion(word, candidates);
  constexpr std::size_t most_listed = 12;
  if (!text.empty() || is_full() || candidates.size() > most_listed) return text;
  if (candidates.empty()) return "; it has none";
  for (const std::string_view name : candidates)
    text += (text.empty() ? "; its " + std::string(plural) + ": " : std::string(", ")) + std::string(name);
  return text;
}

void Context::report(Code code, const Element& element, std::string_view attribute, std::vector<std::string> args,
                     std::size_t offset, std::size_t length) {
  if (is_full()) return sink_.report({.code = code});  // only counted: finding the place costs time
  const ElementId id = element.id_in_source;
  sink_.report({.code = code,
                .where = attribute.empty() ? source.span(id) : source.span(id, attribute, offset, length),
                .path = source.path(id, attribute),
                .args = std::move(args)});
}

void Context::report_with_related(Code code, const Element& element, std::string_view attribute,
                                  std::vector<std::string> args, const Element& related,
                                  std::string_view related_attribute, std::string note) {
  if (is_full()) return sink_.report({.code = code});
  const ElementId id = element.id_in_source;
  sink_.report({.code = code,
                .where = source.span(id, attribute),
                .path = source.path(id, attribute),
                .args = std::move(args),
                .related = {{source.span(related.id_in_source, related_attribute), std::move(note)}}});
}

bool Context::check(const Element& element, std::string_view attribute, const Expression& expression,
                    const Scope& scope) {
  return check_text(element, attribute, expression.text, 0, scope);
}

bool Context::check(const Element& element, std::string_view attribute, const ExpressionList& list,
                    const Scope& scope) {
  bool good = true;
  for (const expr::ListItem& item : expr::split_list(list.text))
    good = check_text(element, attribute, item.text, item.offset, scope) && good;
  return good;
}

bool Context::check_text(const Element& element, std::string_view attribute, std::string_view text, std::size_t offset,
                         const Scope& scope) {
  const expr::ParseResult parsed = expr::parse_expression(text, document.unit);
  if (!parsed.expression) {
    const expr::ParseError& e = *parsed.error;
    report(e.code, element, attribute, e.args, offset + e.offset, e.length);
    return false;
  }
  bool good = true;
  std::vector<double> slots;
  for (const expr::Name& name : parsed.expression->names()) {
    if (!scope.sees(name.text)) {
      good = false;
      const auto entry = ids.find(name.text);
      if (entry != ids.end() && entry->second.kind == Kind::parameter)
        report(Code::parameter_used_before, element, attribute, {name.text}, offset + name.offset, name.text.size());
      else
        report(Code::expression_unknown_name, element, attribute,
               {name.text, is_full() ? "" : suggestion(name.text, scope.names())}, offset + name.offset,
               name.text.size());
      continue;
    }
    const auto value = values.find(name.text);
    if (value != values.end()) slots.push_back(value->second);
  }
  if (!good || slots.size() != parsed.expression->names().size()) return good;
  const expr::EvalResult result = expr::evaluate(*parsed.expression, slots);
  if (result) return true;
  report(Code::expression_domain, element, attribute,
         {std::string(text.substr(result.failed_offset, result.failed_length))}, offset + result.failed_offset,
         result.failed_length);
  return false;
}

std::optional<double> Context::constant(const Expression& expression) const {
  const expr::ParseResult parsed = expr::parse_expression(expression.text, document.unit);
  if (!parsed.expression) return std::nullopt;
  std::vector<double> slots;
  for (const expr::Name& name : parsed.expression->names()) {
    const auto value = values.find(name.text);
    if (value == values.end()) return std::nullopt;
    slots.push_back(value->second);
  }
  const expr::EvalResult result = expr::evaluate(*parsed.expression, slots);
  return result ? std::optional(result.value) : std::nullopt;
}

std::optional<std::vector<double>> Context::constants(const ExpressionList& list) const {
  std::vector<double> all;
  for (const expr::ListItem& item : expr::split_list(list.text)) {
    const std::optional<double> value = constant(Expression{std::string(item.text)});
    if (!value) return std::nullopt;
    all.push_back(*value);
  }
  return all;
}

void Context::require_positive(const Element& element, std::string_view attribute,
                               const std::optional<Expression>& value) {
  const std::optional<double> v = value ? constant(*value) : std::nullopt;
  if (v && !(*v > 0)) report(Code::value_not_positive, element, attribute, {std::string(attribute), format_number(*v)});
}

void Context::require_not_negative(const Element& element, std::string_view attribute,
                                   const std::optional<Expression>& value) {
  const std::optional<double> v = value ? constant(*value) : std::nullopt;
  if (v && *v < 0) report(Code::value_negative, element, attribute, {std::string(attribute), format_number(*v)});
}

bool Context::is_zero(const std::optional<Expression>& x, const std::optional<Expression>& y,
                      const std::optional<Expression>& z) const {
  return constant(x, 0) == 0.0 && constant(y, 0) == 0.0 && constant(z, 0) == 0.0;
}

bool Context::check_name(const Element& element, std::string_view attribute, std::string_view name) {
  if (!expr::is_valid_name(name)) {
    report(Code::value_name, element, attribute, {std::string(name)});
    return false;
  }
  if (expr::is_reserved_name(name)) {
    report(Code::name_reserved, element, attribute, {std::string(name)});
    return false;
  }
  return true;
}

void Context::declare(Scope& scope, const Element& element, std::string_view attribute, std::string_view name,
                      std::string what) {
  if (const std::string* taken = scope.find(name)) {
    report(Code::name_duplicate, element, attribute, {std::string(name), *taken, what});
    return;
  }
  scope.add(std::string(name), std::move(what));
}

}  // namespace meso
