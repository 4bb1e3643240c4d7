// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the units written in an expression say about its value (docs/specification/expressions.md, section 7.9).
//
//   dimension_of(*parse_expression("5mm + 2*t", unit).expression, names).dimension   // length
//   dimension_of(*parse_expression("5mm + 3deg", unit).expression, {}).clash         // '5mm' and '3deg'
//
// Only a written unit binds. A number without one may be a length, an angle or a rate between the two (0.1 in 0.1*h may
// be radians for each millimetre), so what it is multiplied by says nothing about the product.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "meso/expr/expression.hpp"

namespace meso::expr {

enum class Dimension : std::uint8_t {
  open,    ///< no unit says: fits everything
  number,  ///< a ratio, a sine, an index: fits everything too, and changes nothing that it multiplies
  length,
  angle,
};

/// Of two values that one operation takes, one is a length and one an angle: their texts and the operation's place.
struct DimensionClash {
  std::string_view first, second;
  Dimension first_is = Dimension::open;
  std::uint32_t offset = 0;
  std::uint32_t length = 0;

  [[nodiscard]] Dimension second_is() const {
    return first_is == Dimension::length ? Dimension::angle : Dimension::length;
  }
};

struct DimensionResult {
  Dimension dimension = Dimension::open;  ///< open if there is a clash
  std::optional<DimensionClash> clash;    ///< the first in evaluation order
};

/// `names` holds the dimension of each of the expression's names(), in their order; those left out are open. The texts
/// of a clash point into the expression.
[[nodiscard]] DimensionResult dimension_of(const Expression& expression, std::span<const Dimension> names);

/// They add up, compare and stand for each other.
[[nodiscard]] constexpr bool fits(Dimension a, Dimension b) {
  return a == b || a < Dimension::length || b < Dimension::length;
}

/// "a length", "an angle", "a number"
[[nodiscard]] std::string_view to_text(Dimension dimension);

}  // namespace meso::expr
