// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the text of a STEP file tells before anybody reads its geometry.
//
//   if (const auto fault = step_text_fault(text)) ...   // refused: OpenCASCADE hangs or overruns its stack
//
// Strings ('it''s') and comments (/* ... */) are passed over. Cost: some 10 ns a byte. Thread rule: pure.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace meso::brep {

/// Behind the string or comment that begins at `at` (the end of the text, where it is not closed); else `at`.
[[nodiscard]] std::size_t behind_string_or_comment(std::string_view step, std::size_t at);

/// True if the file has a number that is not one (NaN, Inf).
[[nodiscard]] bool has_bad_number(std::string_view step);
/// What is wrong with the references between the file's entities: one that is missing or there twice, or a circle.
[[nodiscard]] std::optional<std::string> reference_fault(std::string_view step);

/// Either, in words.
[[nodiscard]] std::optional<std::string> step_text_fault(std::string_view step);

}  // namespace meso::brep
