// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words of the language, one table: what the parser obeys, what the help prints, what docs/sdf.md is tested
// against.

#include <cstddef>
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
  strut,
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
  density,
  repeat,
  cylindrical,
  spherical,
  helix,
  union_of,
  intersection,
  difference,
  smooth_union,
  blend,
  dup,
  swap,
  drop,
  over,
  def,
  recall,
};

/// What follows a word: lists of numbers (each an argument of its own), the same or formulas of the point, a formula, a
/// path, the name of a solid.
enum class Follows : std::uint8_t { nothing, numbers, graded, one_or_three, vector_and_number, formula, path, name };

struct Vocable {
  std::string_view word;
  Verb verb;
  std::uint8_t takes, puts;  ///< solids off the stack, and on it
  Follows follows;
  std::uint8_t count;         ///< of numbers, where it is Follows::numbers or graded
  std::string_view argument;  ///< as the help shows it
  std::string_view meaning;
  bool extension;  ///< not in the paper
};

[[nodiscard]] std::span<const Vocable> vocabulary();
/// Null if there is none. Surfaces (tpms.*) and struts (strut.*) are not in the table.
[[nodiscard]] const Vocable* find_vocable(std::string_view word);
/// Its word; "tpms" and "strut" of the two that are not in the table.
[[nodiscard]] std::string_view word_of(Verb verb);
[[nodiscard]] std::size_t solids_taken(Verb verb);

}  // namespace meso::sdf
