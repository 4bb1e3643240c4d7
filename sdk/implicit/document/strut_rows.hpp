// SPDX-License-Identifier: Apache-2.0
#pragma once
// Distances of eight points on a line from a list of capsules: built once per instruction set, equal bits in all.
// Private.

#include <cstddef>

#include "primitive.hpp"

namespace meso::implicit {

inline constexpr std::size_t strut_lanes = 8;

/// Points origin + x * direction.
struct Line {
  Vec3 origin, direction;
};

/// out[i]: the least of the capsules' distances at x[i], i < strut_lanes; HUGE_VAL without capsules. Those of one
/// radius should stand together: they share a root.
using StrutRow = void (*)(const Capsule* capsules, std::size_t count, const Line& line, const double* x, double* out);

/// The best that this machine runs.
[[nodiscard]] StrutRow strut_row();

namespace strut_row_sse2 {
void row(const Capsule*, std::size_t, const Line&, const double*, double*);
}
namespace strut_row_avx2 {
void row(const Capsule*, std::size_t, const Line&, const double*, double*);
}
namespace strut_row_avx512 {
void row(const Capsule*, std::size_t, const Line&, const double*, double*);
}

}  // namespace meso::implicit
