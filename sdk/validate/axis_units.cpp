// SPDX-License-Identifier: Apache-2.0
// degrees are not steps along a length. A formula is not looked into: 4mm*phi/1rad may be meant.
#include <algorithm>
#include <array>

#include "families.hpp"
#include "meso/expr/expression.hpp"

namespace meso {
namespace {

enum class Measure { length, angle };

/// Of a number with a unit and nothing else; nothing for anything else.
std::optional<Measure> measure_of(std::string_view text, LengthUnit document_unit) {
  const auto parsed = expr::parse_expression(text, document_unit);
  if (!parsed.expression) return std::nullopt;
  const auto& nodes = parsed.expression->nodes();
  const bool is_literal =
      nodes.front().op == expr::Op::number &&
      std::all_of(nodes.begin() + 1, nodes.end(), [](const expr::Node& n) { return n.op == expr::Op::negate; });
  if (!is_literal) return std::nullopt;
  const std::string_view literal = text.substr(nodes.front().offset, nodes.front().length);
  const std::size_t last_digit = literal.find_last_of("0123456789.");
  if (last_digit == std::string_view::npos) return std::nullopt;  // pi
  const std::string_view unit = literal.substr(last_digit + 1);
  if (unit == "deg" || unit == "rad") return Measure::angle;
  static constexpr std::array<std::string_view, 6> lengths{"um", "mm", "cm", "m", "in", "ft"};
  return std::ranges::find(lengths, unit) != lengths.end() ? std::optional(Measure::length) : std::nullopt;
}

void check(Context& c, const Element& element, std::string_view attribute, std::string_view text, std::size_t offset,
           Measure wanted, const std::string& along) {
  const auto found = measure_of(text, c.document.unit);
  if (!found || *found == wanted) return;
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const std::string_view literal = text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
  c.report(Code::axis_unit, element, attribute,
           {std::string(literal), *found == Measure::angle ? "an angle" : "a length", along,
            wanted == Measure::angle ? "angles" : "lengths"},
           offset + begin, literal.size());
}

}  // namespace

void check_axis_unit(Context& c, const Element& element, std::string_view attribute,
                     const std::optional<Expression>& value, const Axis* axis) {
  if (!value || (axis != nullptr && axis->kind == AxisKind::scalar)) return;
  const bool turns = axis != nullptr && axis->kind == AxisKind::circular;
  check(c, element, attribute, value->text, 0, turns ? Measure::angle : Measure::length,
        axis == nullptr ? "a direction" : "the axis '" + axis->name.text + "'");
}

void check_axis_units(Context& c, const Element& element, std::string_view attribute, const ExpressionList& values,
                      std::span<const Axis> axes) {
  const std::vector<expr::ListItem> items = expr::split_list(values.text);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Axis& axis = axes[std::min(i, axes.size() - 1)];
    if (axis.kind == AxisKind::scalar) continue;
    check(c, element, attribute, items[i].text, items[i].offset,
          axis.kind == AxisKind::circular ? Measure::angle : Measure::length, "the axis '" + axis.name.text + "'");
  }
}

}  // namespace meso
