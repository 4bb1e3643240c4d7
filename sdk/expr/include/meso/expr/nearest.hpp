// SPDX-License-Identifier: Apache-2.0
#pragma once
// The candidate that a mistyped word most likely meant.
//
//   nearest("flor", {"floor", "ceil"})   // "floor"

#include <span>
#include <string_view>

namespace meso::expr {

/// The candidate with the fewest single-letter edits (insert, delete, replace, swap of neighbours; case is free), if
/// they are at most one third of the word's length and at least one is allowed; the first of equals; else empty.
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace meso::expr
