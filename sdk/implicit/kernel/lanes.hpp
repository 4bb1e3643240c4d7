// SPDX-License-Identifier: Apache-2.0
#pragma once
// A few doubles side by side, as wide as the instruction set that this file is compiled for, and the elementary
// functions on them. Included only by row_kernels.cpp. Everything has internal linkage and nothing of the standard
// library is inlined: a function compiled here for AVX-512 must never be the copy that the linker keeps for all.

#include <immintrin.h>
#include <math.h>

#include <cstddef>
#include <cstdint>

namespace meso::implicit {
namespace {

#if defined(__AVX512F__)
constexpr std::size_t width = 8;
#elif defined(__AVX2__)
constexpr std::size_t width = 4;
#else
constexpr std::size_t width = 2;
#endif

using Lanes = double __attribute__((vector_size(width * sizeof(double))));
using Bits = std::int64_t __attribute__((vector_size(width * sizeof(double))));
using Unsigned = std::uint64_t __attribute__((vector_size(width * sizeof(double))));
using Floats = float __attribute__((vector_size(width * sizeof(float))));

inline Lanes splat(double v) { return v - Lanes{}; }
inline Lanes load(const double* p) { return *reinterpret_cast<const Lanes*>(p); }
inline void store(double* p, Lanes v) { *reinterpret_cast<Lanes*>(p) = v; }
inline Lanes absolute(Lanes v) { return (Lanes)((Bits)v & INT64_MAX); }
inline Lanes with_sign_of(Lanes magnitude, Lanes v) { return (Lanes)((Bits)magnitude | ((Bits)v & INT64_MIN)); }
inline Lanes truth(Bits condition) { return (Lanes)(condition & (Bits)splat(1)); }

#if defined(__AVX512F__)
inline Lanes square_root(Lanes v) { return (Lanes)_mm512_maskz_sqrt_pd(0xff, (__m512d)v); }
inline unsigned sign_bits(Bits v) { return _mm512_movepi64_mask((__m512i)v); }
inline unsigned negative(Lanes v) { return _mm512_cmp_pd_mask((__m512d)v, _mm512_setzero_pd(), _CMP_LT_OQ); }
#elif defined(__AVX2__)
inline Lanes square_root(Lanes v) { return (Lanes)_mm256_sqrt_pd((__m256d)v); }
inline unsigned sign_bits(Bits v) { return static_cast<unsigned>(_mm256_movemask_pd((__m256d)v)); }
inline unsigned negative(Lanes v) { return sign_bits(v < Lanes{}); }
#else
inline Lanes square_root(Lanes v) { return (Lanes)_mm_sqrt_pd((__m128d)v); }
inline unsigned sign_bits(Bits v) { return static_cast<unsigned>(_mm_movemask_pd((__m128d)v)); }
inline unsigned negative(Lanes v) { return sign_bits(v < Lanes{}); }
#endif

/// Adding it leaves the nearest whole number in the low bits, in two's complement (magnitudes below 2^51).
constexpr double round_shift = 0x1.8p52;

/// Lanes beyond the range of our own formula ask the C library.
template <class Function>
inline Lanes patched(Lanes result, Bits beyond, Lanes a, Lanes b, Function exact) {
  if (sign_bits(beyond) == 0) [[likely]]
    return result;
  for (std::size_t k = 0; k < width; ++k)
    if (beyond[k]) result[k] = exact(a[k], b[k]);
  return result;
}

inline Lanes within_one(Lanes v) {
  const Lanes below = v > 1 ? splat(1) : v;
  return below < -1 ? splat(-1) : below;
}

/// sin r for |r| <= pi/2: its power series; the next term is below 2e-18.
inline Lanes sine_series(Lanes r) {
  const Lanes s = r * r;
  Lanes p = splat(1 / 51090942171709440000.);
  p = p * s - 1 / 121645100408832000.;
  p = p * s + 1 / 355687428096000.;
  p = p * s - 1 / 1307674368000.;
  p = p * s + 1 / 6227020800.;
  p = p * s - 1 / 39916800.;
  p = p * s + 1 / 362880.;
  p = p * s - 1 / 5040.;
  p = p * s + 1 / 120.;
  p = p * s - 1 / 6.;
  return within_one(r + r * (s * p));
}

/// x - m pi, pi in three parts (Cody and Waite): m has at most 22 bits, so the first two products are exact.
inline Lanes less_multiple_of_pi(Lanes x, Lanes m) {
  return ((x - m * 0x1.921fb544p+1) - m * 0x1.0b4611a4p-33) - m * 0x1.13198a2e03707p-64;
}
constexpr double trigonometric_range = 5e6;

inline Lanes sine(Lanes x) {
  const Lanes shifted = x * 0x1.45f306dc9c883p-2 + round_shift;  // 1 / pi
  const Lanes r = less_multiple_of_pi(x, shifted - round_shift);
  const Lanes result = (Lanes)((Bits)sine_series(r) ^ ((Bits)shifted << 63));
  return patched(result, ~(absolute(x) <= trigonometric_range), x, x, [](double v, double) { return ::sin(v); });
}

inline Lanes cosine(Lanes x) {  // cos(r + (n + 1/2) pi) = -(-1)^n sin r
  const Lanes shifted = (x * 0x1.45f306dc9c883p-2 - 0.5) + round_shift;
  const Lanes r = less_multiple_of_pi(x, (shifted - round_shift) + 0.5);
  const Lanes result = (Lanes)((Bits)sine_series(r) ^ (~(Bits)shifted << 63));
  return patched(result, ~(absolute(x) <= trigonometric_range), x, x, [](double v, double) { return ::cos(v); });
}

/// cos r for |r| <= pi/4, as the sine.
inline Lanes cosine_series(Lanes r) {
  const Lanes s = r * r;
  Lanes p = splat(1 / 20922789888000.);
  p = p * s - 1 / 87178291200.;
  p = p * s + 1 / 479001600.;
  p = p * s - 1 / 3628800.;
  p = p * s + 1 / 40320.;
  p = p * s - 1 / 720.;
  p = p * s + 1 / 24.;
  return 1 - (0.5 * s - s * s * p);
}

inline Lanes tangent(Lanes x) {
  const Lanes shifted = x * 0x1.45f306dc9c883p-1 + round_shift;  // 2 / pi
  const Lanes r = less_multiple_of_pi(x, (shifted - round_shift) * 0.5);
  const Lanes s = sine_series(r), c = cosine_series(r);
  const Bits odd = ((Bits)shifted & 1) != 0;
  const Lanes result = (odd ? -c : s) / (odd ? s : c);
  return patched(result, ~(absolute(x) <= trigonometric_range), x, x, [](double v, double) { return ::tan(v); });
}

/// The angle in [0, pi/2] with tangent y / x, y and x >= 0: one of three eighths of a turn, and the rest t by a
/// polynomial with |t| <= tan(pi/8) (Chebyshev nodes; off by less than 6e-18 t).
inline Lanes first_quadrant_angle(Lanes y, Lanes x) {
  const Bits low = y <= 0x1.a827999fcef32p-2 * x;  // tan(pi/8)
  const Bits high = y > 0x1.3504f333f9de6p+1 * x;  // tan(3 pi/8)
  const Lanes t = (low ? y : high ? -x : y - x) / (low ? x : high ? y : y + x);
  const Lanes q = t * t;
  Lanes p = splat(-0x1.3a31b1c0fd3b7p-6);
  p = p * q + 0x1.4162c02b1dda3p-5;
  p = p * q - 0x1.a0999c632b6edp-5;
  p = p * q + 0x1.dfe6497e96323p-5;
  p = p * q - 0x1.10fa77b1a6d57p-4;
  p = p * q + 0x1.3b1263064f6b9p-4;
  p = p * q - 0x1.745d0b28a7e37p-4;
  p = p * q + 0x1.c71c71853d7fap-4;
  p = p * q - 0x1.2492492436201p-3;
  p = p * q + 0x1.999999999934cp-3;
  p = p * q - 0x1.5555555555555p-2;
  const Lanes rest = t * (q * p);
  const Lanes turn = low ? Lanes{} : high ? splat(0x1.921fb54442d18p+0) : splat(0x1.921fb54442d18p-1);
  return turn + (t + (rest + turn * 0x1.678afae35cdd1p-55));  // what turn lacks
}

inline Lanes arc_tangent(Lanes x) {
  return patched(with_sign_of(first_quadrant_angle(absolute(x), splat(1)), x), ~(absolute(x) <= 1e300), x, x,
                 [](double v, double) { return ::atan(v); });
}

/// zeros count as positive.
inline Lanes arc_tangent2(Lanes y, Lanes x) {
  const Lanes a = absolute(y), b = absolute(x), larger = a > b ? a : b;
  const Lanes angle = first_quadrant_angle(a, b);
  const Lanes result = with_sign_of(x < 0 ? 0x1.921fb54442d18p+1 - (angle - 0x1.1a62633145c07p-53) : angle, y + 0.0);
  return patched(result, ~((larger <= 1e300) & (larger >= 1e-300) & (a >= 0) & (b >= 0)), y + 0.0, x + 0.0,
                 [](double v, double u) { return ::atan2(v, u); });
}

inline Lanes arc_sine(Lanes x) { return arc_tangent2(x, square_root((1 - x) * (1 + x))); }
inline Lanes arc_cosine(Lanes x) { return arc_tangent2(square_root((1 - x) * (1 + x)), x); }

/// 2^k for whole k in [-1022, 1023].
inline Lanes power_of_two(Lanes k) { return (Lanes)(((Bits)(k + (round_shift + 1023))) << 52); }

inline Lanes exponential(Lanes x) {
  const Lanes n = (x * 0x1.71547652b82fep+0 + round_shift) - round_shift;  // 1 / ln 2
  const Lanes r = (x - n * 0x1.62e42fefap-1) - n * 0x1.cf79abc9e3b3ap-40;
  Lanes p = splat(1 / 6227020800.);
  p = p * r + 1 / 479001600.;
  p = p * r + 1 / 39916800.;
  p = p * r + 1 / 3628800.;
  p = p * r + 1 / 362880.;
  p = p * r + 1 / 40320.;
  p = p * r + 1 / 5040.;
  p = p * r + 1 / 720.;
  p = p * r + 1 / 120.;
  p = p * r + 1 / 24.;
  p = p * r + 1 / 6.;
  p = p * r + 0.5;
  const Lanes result = (1 + (r + r * r * p)) * power_of_two(n);
  return patched(result, ~(absolute(x) <= 700), x, x, [](double v, double) { return ::exp(v); });
}

/// x = mantissa 2^exponent, mantissa in [sqrt 1/2, sqrt 2]; for normal x > 0.
struct Fraction {
  Lanes mantissa, exponent;
};
inline Fraction fraction_of(Lanes x) {
  const Bits bits = (Bits)x;
  const Lanes mantissa = (Lanes)((bits & 0xfffffffffffff) | (Bits)splat(1));
  const Bits halve = mantissa > 0x1.6a09e667f3bcdp+0;
  const Lanes biased = (Lanes)((Bits)((Unsigned)bits >> 52) | (Bits)splat(0x1p52)) - 0x1p52;
  return {halve ? mantissa * 0.5 : mantissa, biased - 1023 + truth(halve)};
}

/// 2/3 + 2/5 q + 2/7 q^2 + ...: 2 artanh s = 2 s + s^3 times this, q = s^2.
inline Lanes artanh_series(Lanes q) {
  Lanes p = splat(2 / 23.);
  p = p * q + 2 / 21.;
  p = p * q + 2 / 19.;
  p = p * q + 2 / 17.;
  p = p * q + 2 / 15.;
  p = p * q + 2 / 13.;
  p = p * q + 2 / 11.;
  p = p * q + 2 / 9.;
  p = p * q + 2 / 7.;
  p = p * q + 2 / 5.;
  p = p * q + 2 / 3.;
  return p;
}

/// ln x = k ln 2 + ln(1 + f); with s = f / (2 + f) that logarithm is 2 artanh s, written as f - s (f - 2 s^2/3 - ...)
/// because f is exact.
inline Lanes logarithm(Lanes x) {
  const Fraction fraction = fraction_of(x);
  const Lanes f = fraction.mantissa - 1;
  const Lanes s = f / (2 + f);
  const Lanes q = s * s;
  const Lanes of_fraction = f - s * (f - q * artanh_series(q));
  const Lanes result = fraction.exponent * 0x1.62e42fefap-1 + (of_fraction + fraction.exponent * 0x1.cf79abc9e3b3ap-40);
  return patched(result, ~((x >= 0x1p-1022) & (x <= 0x1.fffffffffffffp+1023)), x, x,
                 [](double v, double) { return ::log(v); });
}

/// A number as a sum of two doubles, the second what the first lacks.
struct Double {
  Lanes head, tail;
};

/// Dekker: a * b to the last bit. REQUIRES: magnitudes below 1e150.
inline Double product(Lanes a, Lanes b) {
  const Lanes p = a * b, a_shifted = a * 0x1.0000002p27, b_shifted = b * 0x1.0000002p27;
  const Lanes a1 = a_shifted - (a_shifted - a), a2 = a - a1, b1 = b_shifted - (b_shifted - b), b2 = b - b1;
  return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

/// Knuth: a + b to the last bit.
inline Double sum(Lanes a, Lanes b) {
  const Lanes s = a + b, of_b = s - a;
  return {s, (a - (s - of_b)) + (b - of_b)};
}

/// As logarithm(), with 59 bits: s and what surrounds its series in two parts each. For normal x > 0.
inline Double precise_logarithm(Lanes x) {
  const Fraction fraction = fraction_of(x);
  const Double divisor = sum(splat(1), fraction.mantissa);
  const Lanes f = fraction.mantissa - 1, s = f / divisor.head;
  const Double back = product(s, divisor.head);
  const Lanes s_tail = (((f - back.head) - back.tail) - s * divisor.tail) / divisor.head;
  const Lanes q = s * s;
  const Lanes rest = s * (q * artanh_series(q)) + 2 * (s_tail + q * s_tail);
  const Double high = sum(fraction.exponent * 0x1.62e42fefap-1, 2 * s);
  return sum(high.head, high.tail + (rest + fraction.exponent * 0x1.cf79abc9e3b3ap-40));
}

/// exp(y ln x) where that is moderate; signs, zeros and what is far from 1 are left to the C library.
inline Lanes power(Lanes x, Lanes y) {
  const Bits positive = (x >= 0x1p-1022) & (x <= 0x1.fffffffffffffp+1023) & (absolute(y) <= 1e10);
  const Double ln_x = precise_logarithm(positive ? x : splat(1));
  const Double exponent = product(positive ? y : Lanes{}, ln_x.head);
  const Bits within = positive & (absolute(exponent.head) <= 50);
  const Lanes result = exponential(within ? exponent.head : Lanes{});
  return patched(result + result * (exponent.tail + y * ln_x.tail), ~within, x, y,
                 [](double v, double u) { return ::pow(v, u); });
}

inline Lanes hypotenuse(Lanes x, Lanes y) {
  const Lanes a = absolute(x), b = absolute(y), larger = a < b ? b : a;
  const Bits beyond = ~((larger <= 1e150) & ((larger >= 1e-140) | (larger == 0)));
  return patched(square_root(x * x + y * y), beyond | ~(x == x) | ~(y == y), x, y,
                 [](double u, double v) { return ::hypot(u, v); });
}

/// Nearest whole number, halves away from zero.
inline Lanes rounded(Lanes x) {
  const Lanes a = absolute(x);
  const Lanes even = (a + 0x1p52) - 0x1p52;  // halves to even
  const Lanes up = even + truth(a - even >= 0.5);
  return with_sign_of(a < 0x1p52 ? up : a, x);
}

inline Lanes snapped(Lanes x) {
  const Lanes nearest = rounded(x), a = absolute(x), one = splat(1);
  return absolute(x - nearest) <= 1e-9 * (a > one ? a : one) ? nearest : x;
}

inline Lanes floored(Lanes x) {
  const Lanes v = snapped(x), nearest = rounded(v);
  return nearest > v ? nearest - 1 : nearest;
}

}  // namespace
}  // namespace meso::implicit
