// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set (MESO_STRUT_ISA). Nothing of the standard library is called here: what is inlined
// for AVX-512 must never be the copy that the linker keeps for all.
#include "strut_rows.hpp"

#define MESO_JOIN2(a, b) a##b
#define MESO_JOIN(a, b) MESO_JOIN2(a, b)

namespace meso::implicit {
namespace {

using Lanes = double __attribute__((vector_size(strut_lanes * sizeof(double))));

struct Unaligned {
  Lanes lanes;
} __attribute__((packed, may_alias));

}  // namespace

namespace MESO_JOIN(strut_row_, MESO_STRUT_ISA) {

// The same operations in the same order as axis_distance().
void row(const Capsule* capsules, std::size_t count, const Line& line, const double* x, double* out) {
  const Lanes zero{}, one = zero + 1, xs = reinterpret_cast<const Unaligned*>(x)->lanes;
  const Lanes px = line.origin.x + xs * line.direction.x, py = line.origin.y + xs * line.direction.y,
              pz = line.origin.z + xs * line.direction.z;
  Lanes best = zero + __builtin_huge_val();
  for (std::size_t c = 0; c < count;) {
    const double radius = capsules[c].radius;
    Lanes nearest = zero + __builtin_huge_val();
    for (; c < count && capsules[c].radius == radius; ++c) {
      const Capsule& s = capsules[c];
      const Lanes wx = px - s.from.x, wy = py - s.from.y, wz = pz - s.from.z;
      Lanes t = (wx * s.axis.x + wy * s.axis.y + wz * s.axis.z) * s.inverse_length2;
      t = t < zero ? zero : t;
      t = t > one ? one : t;
      const Lanes dx = wx - t * s.axis.x, dy = wy - t * s.axis.y, dz = wz - t * s.axis.z;
      const Lanes d = dx * dx + dy * dy + dz * dz;
      nearest = d < nearest ? d : nearest;
    }
    for (std::size_t i = 0; i < strut_lanes; ++i) nearest[i] = __builtin_sqrt(nearest[i]);
    nearest -= radius;
    best = nearest < best ? nearest : best;
  }
  reinterpret_cast<Unaligned*>(out)->lanes = best;
}

}  // namespace MESO_JOIN(strut_row_, MESO_STRUT_ISA)
}  // namespace meso::implicit
