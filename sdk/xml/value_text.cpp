// SPDX-License-Identifier: Apache-2.0
#include "value_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "meso/expr/nearest.hpp"

namespace meso::xml {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// [+-]? digits [. digits?] [e[+-]digits] | [+-]? . digits [e...]: the pattern of the schema's type Number.
bool is_decimal(std::string_view text) {
  std::size_t i = 0;
  const auto digits = [&] {
    const std::size_t first = i;
    while (i < text.size() && is_digit(text[i])) ++i;
    return i - first;
  };
  const auto sign = [&] { i += i < text.size() && (text[i] == '+' || text[i] == '-') ? 1 : 0; };
  sign();
  std::size_t mantissa = digits();
  if (i < text.size() && text[i] == '.') {
    ++i;
    mantissa += digits();
  }
  if (mantissa == 0) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    sign();
    if (digits() == 0) return false;
  }
  return i == text.size();
}

/// Units are written short in expressions and out as attributes: empty if `text` is none, or none of the choices.
std::string_view written_out(std::string_view text, const std::vector<std::string_view>& choices) {
  static constexpr auto units = std::to_array<std::pair<std::string_view, std::string_view>>({{"um", "micrometer"},
                                                                                              {"mm", "millimeter"},
                                                                                              {"cm", "centimeter"},
                                                                                              {"m", "meter"},
                                                                                              {"in", "inch"},
                                                                                              {"ft", "foot"}});
  const auto unit = std::ranges::find(units, text, [](const auto& pair) { return pair.first; });
  return unit != units.end() && std::ranges::find(choices, unit->second) != choices.end() ? unit->second : "";
}

}  // namespace

bool is_name(std::string_view text) {
  const auto starts = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !text.empty() && starts(text[0]) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return starts(c) || is_digit(c); });
}

std::optional<ValueFault> parse_value(std::string_view attribute, std::string_view text, std::string& value) {
  value = text;
  const auto is_hex = [](char c) { return is_digit(c) || (c >= 'a' && c <= 'f'); };
  // The name means one thing wherever it stands, so it needs no type of its own.
  if (attribute == "sha256" && (text.size() != 64 || !std::all_of(text.begin(), text.end(), is_hex)))
    return ValueFault{Code::value_sha256, {value}};
  return std::nullopt;
}

std::optional<ValueFault> parse_value(std::string_view, std::string_view text, double& value) {
  if (!is_decimal(text)) {
    const bool comma = text.find(',') != std::string_view::npos;
    return ValueFault{Code::value_number, {std::string(text), comma ? "; decimals are set off by a point" : ""}};
  }
  const auto number = parse_number(text);
  if (!number) return ValueFault{Code::value_number_range, {std::string(text)}};
  value = *number;
  return std::nullopt;
}

std::optional<ValueFault> parse_value(std::string_view, std::string_view text, std::int64_t& value) {
  const bool digits = !text.empty() && text.size() <= 18 && std::all_of(text.begin(), text.end(), is_digit);
  if (!digits) return ValueFault{Code::value_integer, {std::string(text)}};
  value = *parse_integer(text);
  return std::nullopt;
}

std::optional<ValueFault> parse_value(std::string_view, std::string_view text, bool& value) {
  value = text == "true";
  if (!value && text != "false") return ValueFault{Code::value_boolean, {std::string(text)}};
  return std::nullopt;
}

std::optional<ValueFault> choice_fault(std::string_view attribute, std::string_view text,
                                       const std::vector<std::string_view>& choices) {
  std::string list;
  for (const std::string_view c : choices) list += (list.empty() ? "" : ", ") + std::string(c);
  const std::string_view near = expr::nearest(text, choices);
  const std::string_view meant = near.empty() ? written_out(text, choices) : near;
  return ValueFault{Code::value_choice,
                    {std::string(text), std::string(attribute), list,
                     meant.empty() ? "" : "; did you mean '" + std::string(meant) + "'?"}};
}

}  // namespace meso::xml
