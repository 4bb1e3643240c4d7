// SPDX-License-Identifier: Apache-2.0
#pragma once
// Numbers as text: locale-free, whole string, finite, shortest round trip.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meso {

/// The decimal number `text` is, correctly rounded; empty if any character is left over, or the value is not finite.
/// Accepts what the document's grammar calls a number: [+-]? digits [. digits] [e[+-]digits] | [+-]? . digits ...
[[nodiscard]] std::optional<double> parse_number(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);

/// Shortest text that reads back as the same double ("5", "0.1", "1e-06").
[[nodiscard]] std::string format_number(double value);

}  // namespace meso
