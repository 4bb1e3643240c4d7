// SPDX-License-Identifier: Apache-2.0
#include "scope.hpp"

#include <algorithm>

#include "meso/expr/nearest.hpp"

namespace meso::eval {

void Report::at(Code code, const Place& place, std::size_t offset, std::size_t length,
                std::vector<std::string> args) const {
  const SourceSpan where = length == 0 ? source.span(place.element, place.attribute)
                                       : source.span(place.element, place.attribute, place.offset + offset, length);
  sink.report({.code = code,
               .where = where,
               .path = source.path(place.element, place.attribute),
               .args = std::move(args),
               .related = related});
}

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string_view near = expr::nearest(word, candidates);
  return near.empty() ? std::string() : "; did you mean '" + std::string(near) + "'?";
}

bool BoundExpression::names(std::string_view name) const {
  const auto& all = expression.names();
  return std::any_of(all.begin(), all.end(), [&](const expr::Name& n) { return n.text == name; });
}

void Scope::define(std::string_view name, std::uint32_t slot, int level) {
  entries_.insert_or_assign(std::string(name), Entry{slot, level});
}

std::optional<BoundExpression> Scope::bind(std::string_view text, const Place& place, LengthUnit unit,
                                           const Report& report) const {
  const expr::ParseResult parsed = expr::parse_expression(text, unit);
  if (!parsed.expression) {
    report.at(parsed.error->code, place, parsed.error->offset, parsed.error->length, parsed.error->args);
    return std::nullopt;
  }
  std::vector<std::uint32_t> slots;
  int level = constant_level;
  for (const expr::Name& name : parsed.expression->names()) {
    const auto entry = entries_.find(name.text);
    if (entry == entries_.end()) {
      std::vector<std::string_view> known;
      for (const auto& [candidate, unused] : entries_) known.push_back(candidate);
      report.at(Code::expression_unknown_name, place, name.offset, name.text.size(),
                {name.text, suggestion(name.text, known)});
      return std::nullopt;
    }
    slots.push_back(entry->second.slot);
    level = std::max(level, entry->second.level);
  }
  return BoundExpression{parsed.expression->bind(slots), level, place};
}

std::optional<std::vector<BoundExpression>> Scope::bind_list(std::string_view text, const Place& place,
                                                             std::size_t count, LengthUnit unit,
                                                             const Report& report) const {
  const std::vector<expr::ListItem> items = expr::split_list(text);
  if (items.size() != count) {
    report(Code::expression_list_count, place, {std::to_string(count), std::to_string(items.size())});
    return std::nullopt;
  }
  std::vector<BoundExpression> bound;
  for (const expr::ListItem& item : items) {
    auto one = bind(item.text, {place.element, place.attribute, place.offset + item.offset}, unit, report);
    if (!one) return std::nullopt;
    bound.push_back(std::move(*one));
  }
  return bound;
}

}  // namespace meso::eval
