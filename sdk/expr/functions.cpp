// SPDX-License-Identifier: Apache-2.0
#include "functions.hpp"

#include <algorithm>
#include <array>

namespace meso::expr {
namespace {

constexpr std::size_t any_number = max_text_bytes;

constexpr std::array functions = {
    Function{"abs", Op::abs, 1, 1},          Function{"acos", Op::acos, 1, 1},
    Function{"asin", Op::asin, 1, 1},        Function{"atan", Op::atan, 1, 1},
    Function{"atan2", Op::atan2, 2, 2},      Function{"ceil", Op::ceil, 1, 1},
    Function{"clamp", Op::clamp, 3, 3},      Function{"cos", Op::cos, 1, 1},
    Function{"exp", Op::exp, 1, 1},          Function{"floor", Op::floor, 1, 1},
    Function{"hash", Op::hash, 1, 8},        Function{"hypot", Op::hypot, 2, 2},
    Function{"log", Op::log, 1, 1},          Function{"max", Op::max, 1, any_number},
    Function{"min", Op::min, 1, any_number}, Function{"mod", Op::mod, 2, 2},
    Function{"round", Op::round, 1, 1},      Function{"sign", Op::sign, 1, 1},
    Function{"sin", Op::sin, 1, 1},          Function{"sqrt", Op::sqrt, 1, 1},
    Function{"tan", Op::tan, 1, 1},
};

constexpr auto names = [] {
  std::array<std::string_view, functions.size()> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = functions[i].name;
  return all;
}();

constexpr std::array<std::string_view, 5> other_reserved = {"pi", "and", "or", "not", "global"};

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

const Function* find_function(std::string_view name) {
  const auto* const found =
      std::find_if(functions.begin(), functions.end(), [&](const Function& f) { return f.name == name; });
  return found == functions.end() ? nullptr : found;
}

std::span<const std::string_view> function_names() { return names; }

std::string describe_arguments(const Function& function) {
  const std::string least = std::to_string(function.min_arguments);
  if (function.max_arguments == any_number) return least + " or more arguments";
  if (function.max_arguments != function.min_arguments)
    return least + " to " + std::to_string(function.max_arguments) + " arguments";
  return least + (function.min_arguments == 1 ? " argument" : " arguments");
}

bool is_valid_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

bool is_reserved_name(std::string_view text) {
  return find_function(text) != nullptr ||
         std::find(other_reserved.begin(), other_reserved.end(), text) != other_reserved.end();
}

}  // namespace meso::expr
