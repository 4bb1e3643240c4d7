// SPDX-License-Identifier: Apache-2.0
#pragma once
// The closed list of functions and words (docs/specification/expressions.md, section 7.5).

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "meso/expr/expression.hpp"

namespace meso::expr {

struct Function {
  std::string_view name;
  Op op;
  std::size_t min_arguments;
  std::size_t max_arguments;
};

/// Null if there is no such function.
[[nodiscard]] const Function* find_function(std::string_view name);
[[nodiscard]] std::span<const std::string_view> function_names();
/// "2 arguments", "1 or more arguments"
[[nodiscard]] std::string describe_arguments(const Function& function);

}  // namespace meso::expr
