// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words of the language, one table: what the parser obeys, what the help prints, what docs/sdf.md is tested
// against.

#include <cstdint>
#include <span>
#include <string_view>

namespace meso::sdf {

enum class Verb : std::uint8_t {
  ball,
  cylinder,
  box,
  cone,
  torus,
  capsule,
  half_space,
  surface,
  expression,
  file,
  complement,
  offset,
  shell,
  eccentric_shell,
  move,
  scale,
  rotate,
  orient,
  mirror,
  union_of,
  intersection,
  difference,
};

/// What follows a word: lists of numbers (each an argument of its own), a formula or a path.
enum class Follows : std::uint8_t { nothing, numbers, one_or_three, vector_and_number, formula, path };

struct Vocable {
  std::string_view word;
  Verb verb;
  std::uint8_t takes;  ///< solids off the stack; each word puts one on it
  Follows follows;
  std::uint8_t count;         ///< of numbers, where it is Follows::numbers
  std::string_view argument;  ///< as the help shows it
  std::string_view meaning;
  bool extension;  ///< not in the paper
};

[[nodiscard]] std::span<const Vocable> vocabulary();
/// Null if there is none. Surfaces (tpms.*) are not in the table.
[[nodiscard]] const Vocable* find_vocable(std::string_view word);

}  // namespace meso::sdf
