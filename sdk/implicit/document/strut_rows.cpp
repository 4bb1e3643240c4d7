// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set (MESO_STRUT_ISA). Nothing of the standard library is called here: what is inlined
// for AVX-512 must never be the copy that the linker keeps for all.
#include "strut_rows.hpp"

#define MESO_JOIN2(a, b) a##b
#define MESO_JOIN(a, b) MESO_JOIN2(a, b)
#define MESO_STRUT_ROWS MESO_JOIN(strut_row_, MESO_STRUT_ISA)

#include <immintrin.h>

namespace meso::implicit {
namespace {

#if defined(__AVX512F__)
constexpr std::size_t width = 8;
#elif defined(__AVX2__)
constexpr std::size_t width = 4;
#else
constexpr std::size_t width = 2;
#endif
constexpr std::size_t parts = strut_lanes / width;

using Lanes = double __attribute__((vector_size(width * sizeof(double))));
struct Unaligned {
  Lanes lanes;
} __attribute__((packed, may_alias));

inline Lanes splat(double v) { return v - Lanes{}; }
#if defined(__AVX512F__)
inline Lanes square_root(Lanes v) { return (Lanes)_mm512_maskz_sqrt_pd(0xff, (__m512d)v); }
#elif defined(__AVX2__)
inline Lanes square_root(Lanes v) { return (Lanes)_mm256_sqrt_pd((__m256d)v); }
#else
inline Lanes square_root(Lanes v) { return (Lanes)_mm_sqrt_pd((__m128d)v); }
#endif

}  // namespace

namespace MESO_STRUT_ROWS {

// The same operations in the same order as axis_distance().
void row(const Capsule* capsules, std::size_t count, const Line& line, const double* x, double* out) {
  for (std::size_t part = 0; part < parts; ++part) {
    const Lanes xs = reinterpret_cast<const Unaligned*>(x + part * width)->lanes;
    const Lanes px = line.origin.x + xs * line.direction.x, py = line.origin.y + xs * line.direction.y,
                pz = line.origin.z + xs * line.direction.z;
    Lanes best = splat(__builtin_huge_val());
    for (std::size_t c = 0; c < count;) {
      const double radius = capsules[c].radius;
      Lanes nearest = splat(__builtin_huge_val());
      for (; c < count && capsules[c].radius == radius; ++c) {
        const Capsule& s = capsules[c];
        const Lanes wx = px - s.from.x, wy = py - s.from.y, wz = pz - s.from.z;
        Lanes t = (wx * s.axis.x + wy * s.axis.y + wz * s.axis.z) * s.inverse_length2;
        t = t < 0 ? splat(0) : t;
        t = t > 1 ? splat(1) : t;
        const Lanes dx = wx - t * s.axis.x, dy = wy - t * s.axis.y, dz = wz - t * s.axis.z;
        const Lanes d = dx * dx + dy * dy + dz * dz;
        nearest = d < nearest ? d : nearest;
      }
      nearest = square_root(nearest) - radius;
      best = nearest < best ? nearest : best;
    }
    reinterpret_cast<Unaligned*>(out + part * width)->lanes = best;
  }
}

}  // namespace MESO_STRUT_ROWS
}  // namespace meso::implicit
