// SPDX-License-Identifier: Apache-2.0
// ranges of values that are known without evaluation. Nothing is said about values that are not.
#include <cmath>

#include "families.hpp"
#include "meso/expr/expression.hpp"
#include "meso/expr/operations.hpp"

namespace meso {

void require_whole(Context& c, const Element& element, std::string_view attribute, const ExpressionList& list,
                   double least) {
  for (const double value : c.constants(list).value_or(std::vector<double>())) {
    const double n = expr::snap_to_integer(value);  // R-5.4.3: R-7.5.3 decides what is near enough
    if (n == std::round(n) && n >= least && n <= 0x1p53) continue;
    c.report(Code::value_not_whole, element, attribute,
             {std::string(attribute), format_number(least), format_number(value)});
    return;
  }
}

namespace {

struct Bounds {
  double least = -HUGE_VAL, most = HUGE_VAL;
};

/// An unknown bound is no bound.
Bounds bounds_of(const Context& c, const std::optional<Expression>& min, const std::optional<Expression>& max) {
  return {c.constant(min, -HUGE_VAL).value_or(-HUGE_VAL), c.constant(max, HUGE_VAL).value_or(HUGE_VAL)};
}

}  // namespace

void check_bounds(Context& c, const Element& element, std::string_view attribute, const Expression& expression,
                  std::string_view name, const std::optional<Expression>& min, const std::optional<Expression>& max) {
  const auto value = c.constant(expression);
  const auto [least, most] = bounds_of(c, min, max);
  if (!value || least > most) return;
  if (*value < least)
    c.report(Code::parameter_range, element, attribute,
             {std::string(name), format_number(*value), "less than min", format_number(least)});
  else if (*value > most)
    c.report(Code::parameter_range, element, attribute,
             {std::string(name), format_number(*value), "greater than max", format_number(most)});
}

void check_bounds_order(Context& c, const Element& element, const std::optional<Expression>& min,
                        const std::optional<Expression>& max) {
  const auto [least, most] = bounds_of(c, min, max);
  if (least > most) c.report(Code::parameter_bounds, element, "min", {format_number(least), format_number(most)});
}

std::size_t split_count(const ExpressionList& list) { return expr::split_list(list.text).size(); }

}  // namespace meso
