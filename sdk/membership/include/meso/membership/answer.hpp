// SPDX-License-Identifier: Apache-2.0
#pragma once
// Inside, outside, or not known: Kleene's logic, in which union is the maximum and intersection the minimum.
//
//   Answer both = std::min(a.at(p), b.at(p)), either = std::max(a.at(p), b.at(p)), without = complement(a.at(p));
//
// What depends on something unknown is unknown; what does not is still known.

#include <cstdint>

namespace meso::membership {

enum class Answer : std::uint8_t { outside = 0, unknown = 1, inside = 2 };

[[nodiscard]] constexpr Answer complement(Answer a) { return static_cast<Answer>(2 - static_cast<int>(a)); }
[[nodiscard]] constexpr Answer known(bool inside) { return inside ? Answer::inside : Answer::outside; }

}  // namespace meso::membership
