// SPDX-License-Identifier: Apache-2.0
#pragma once
// Arguments as text: lists of constant expressions, formulas of the point, and what a word demands of its numbers.

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "meso/expr/expression.hpp"
#include "meso/implicit/term.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// A part of a text that cannot be read, and why.
struct TextFault {
  std::size_t offset = 0;
  std::size_t length = std::string_view::npos;
  std::string why{};
};

/// What numbers of a list are; one without a unit is whatever is wanted.
enum class Measure : std::uint8_t { length, angle, number };

struct NumberList {
  std::vector<double> numbers{};
  std::optional<TextFault> fault{};
};
/// Constant expressions, separated by the commas outside parentheses; as many as one of `counts`, all finite.
[[nodiscard]] NumberList read_numbers(std::string_view text, std::initializer_list<std::size_t> counts,
                                      Measure measure = Measure::length);

/// Nothing if `text` is an expression of x, y, z, and no length in it is added to an angle.
[[nodiscard]] std::optional<TextFault> formula_fault(std::string_view text);
/// The same of a list of `count`. REQUIRES: a text that holds no such list of numbers.
[[nodiscard]] std::optional<TextFault> formulas_fault(std::string_view text, std::size_t count,
                                                      Measure measure = Measure::length);
/// Whether a formula asks where it is.
[[nodiscard]] bool names_point(std::string_view text);

/// x, y, z and tau known. REQUIRES: a text without fault.
[[nodiscard]] implicit::Term term_of(std::string_view formula);

/// Why the numbers of an instruction make no sense: "a shell's thickness is not negative". Empty: they do.
[[nodiscard]] std::string fault_of(const Instruction& instruction);

}  // namespace meso::sdf
