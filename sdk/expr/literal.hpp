// SPDX-License-Identifier: Apache-2.0
#pragma once
// The value of a number with a unit: the double nearest to the exact result (ties to even), whatever the two units.
//
//   literal_value("0.1", Suffix::in, LengthUnit::millimeter)   // 2.54
//   literal_value("180", Suffix::deg, LengthUnit::millimeter)  // the double nearest to pi

#include <optional>
#include <span>
#include <string_view>

#include "meso/base/unit.hpp"

namespace meso::expr {

enum class Suffix { none, um, mm, cm, m, in, ft, deg, rad };

/// Empty if there is no such unit.
[[nodiscard]] std::optional<Suffix> find_suffix(std::string_view text);
[[nodiscard]] std::span<const std::string_view> suffix_names();

/// `decimal` is what calls a decimal: digits with at most one point and an exponent, no sign. Empty if the
/// value is infinite, or becomes 0 although the decimal is not 0.
[[nodiscard]] std::optional<double> literal_value(std::string_view decimal, Suffix suffix, LengthUnit document_unit);

}  // namespace meso::expr
