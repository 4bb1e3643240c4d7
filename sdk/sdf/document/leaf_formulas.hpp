// SPDX-License-Identifier: Apache-2.0
#pragma once
// The texts by which documents say what the words of the command language mean, read both ways. Private.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "meso/sdf/vocabulary.hpp"

namespace meso::sdf {

/// A primitive as the field of an implicit body; its sizes are parameters of the cell.
struct LeafFormula {
  Verb verb{};
  std::string_view field;
  std::vector<std::string_view> parameters{};
};
[[nodiscard]] std::span<const LeafFormula> leaf_formulas();

/// Names of an expression replaced: meaning(name), or the name itself where that is nothing.
template <class Meaning>
[[nodiscard]] std::string renamed(std::string_view text, const Meaning& meaning) {
  std::string result;
  const auto is_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && is_word(text[end])) ++end;
    if (end == i) {
      result += text[i++];
      continue;
    }
    const std::string name(text.substr(i, end - i));
    const std::optional<std::string> other = meaning(name);
    result += other ? *other : name;
    i = end;
  }
  return result;
}

/// A formula of words as one of documents, which do not know tau.
[[nodiscard]] std::string in_document(std::string_view formula);

/// F(x, y, z) as scale*(F(x/scale, y/scale, z/scale)), and back.
[[nodiscard]] std::string scaled_field(std::string_view field);
[[nodiscard]] std::optional<std::string> unscaled_field(std::string_view field);

/// Weights of blends count at most 1 and at least 0 in words; documents demand it.
[[nodiscard]] std::string clamped(std::string_view weight);
[[nodiscard]] std::string unclamped(std::string_view weight);

/// Of what is blended, the share alike: (1 - weight)*one + weight*other. And back: nothing if it is not written so.
[[nodiscard]] std::string blended_share(std::string_view one, std::string_view other, std::string_view weight);
[[nodiscard]] std::optional<std::pair<std::string, std::string>> shares_of(std::string_view blended,
                                                                           std::string_view weight);

/// The matrix of a mirror or of a scale with negative factors, of parameters whose names begin so, and back.
[[nodiscard]] std::string mirror_matrix(const std::string& prefix);
[[nodiscard]] std::string scale_matrix(const std::string& prefix);
/// The prefix; empty if it is no such matrix.
[[nodiscard]] std::string prefix_of_matrix(std::string_view matrix, std::string (*make)(const std::string&));

}  // namespace meso::sdf
