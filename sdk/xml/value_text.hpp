// SPDX-License-Identifier: Apache-2.0
#pragma once
// Attribute values as text: strict in, shortest out.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/number.hpp"
#include "meso/model/describe.hpp"
#include "shape.hpp"

namespace meso::xml {

/// Why a text is not a value; `args` are those of the code's message.
struct ValueFault {
  Code code{};
  std::vector<std::string> args;
};

/// [A-Za-z_][A-Za-z0-9_]*
[[nodiscard]] bool is_name(std::string_view text);

std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, std::string& value);
std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, double& value);
std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, std::int64_t& value);
std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, bool& value);
[[nodiscard]] std::optional<ValueFault> choice_fault(std::string_view attribute, std::string_view text,
                                                     const std::vector<std::string_view>& choices);

template <class T>
requires requires(T v) { v.text; }
std::optional<ValueFault> parse_value(std::string_view, std::string_view text, T& value) {
  value.text = text;
  constexpr ValueKind kind = value_kind<T>();
  constexpr bool named = kind == ValueKind::id || kind == ValueKind::name || kind == ValueKind::reference;
  if (named && !is_name(text)) return ValueFault{Code::value_name, {std::string(text)}};
  return std::nullopt;
}
template <class T>
requires std::is_enum_v<T> std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text,
                                                                 T& value) {
  for (std::size_t i = 0; i < enum_texts<T>.size(); ++i) {
    if (enum_texts<T>[i] != text) continue;
    value = static_cast<T>(i);
    return std::nullopt;
  }
  return choice_fault(attribute, text, {enum_texts<T>.begin(), enum_texts<T>.end()});
}
template <class T>
std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, std::optional<T>& value) {
  return parse_value(attribute, text, value.emplace());
}

[[nodiscard]] inline std::string value_text(const std::string& value) { return value; }
[[nodiscard]] inline std::string value_text(double value) { return format_number(value); }
[[nodiscard]] inline std::string value_text(std::int64_t value) { return std::to_string(value); }
[[nodiscard]] inline std::string value_text(bool value) { return value ? "true" : "false"; }
template <class T>
requires requires(T v) { v.text; }
[[nodiscard]] std::string value_text(const T& value) { return value.text; }
template <class T>
requires std::is_enum_v<T>
[[nodiscard]] std::string value_text(T value) { return std::string(enum_texts<T>[static_cast<std::size_t>(value)]); }

}  // namespace meso::xml
