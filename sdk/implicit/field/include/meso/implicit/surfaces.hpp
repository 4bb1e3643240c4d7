// SPDX-License-Identifier: Apache-2.0
#pragma once
// The periodic surfaces that have names. The table is sdk/implicit/field/surfaces.csv and nothing else: the compiled
// one is made from it, docs/specification/surfaces.md is checked against it.
//
//   find_surface("tpms.schwarz-p")->name == "p"
//   nearest_surface("gyroyd") == "gyroid"

#include <span>
#include <string_view>

namespace meso::implicit {

struct Surface {
  std::string_view name;        ///< "g-prime"; in the command language with "tpms." before it
  std::string_view title;       ///< as printed: "G'"
  std::string_view aliases;     ///< names separated by spaces
  std::string_view expression;  ///< of x, y, z
  double min = 0, max = 0;      ///< hold every value of the expression
  double lipschitz = 0;         ///< a bound of |gradient|
};

/// In the table's order.
[[nodiscard]] std::span<const Surface> surfaces();
/// By name or alias, with or without "tpms." before it; null if there is none. Upper and lower case differ.
[[nodiscard]] const Surface* find_surface(std::string_view name);
/// The name or alias that was most likely meant; empty if none is near. Without "tpms.".
[[nodiscard]] std::string_view nearest_surface(std::string_view name);

}  // namespace meso::implicit
