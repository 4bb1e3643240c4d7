// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one definition of every operation's arithmetic (docs/specification/expressions.md, section 7.5), shared by the
// plain walk and by every other evaluator, so that they agree bit for bit.
//
//   apply<Op::floor>(2.9999999999)   // 3
//   apply<Op::divide>(1, 0)          // infinity: the caller turns what is not finite into a domain error
//
// Arguments are finite. A result that is not finite means that the operation has no value there.

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "meso/expr/expression.hpp"

namespace meso::expr {

/// values that missed an integer by rounding noise are that integer.
[[nodiscard]] inline double snap_to_integer(double x) {
  const double nearest = std::round(x);
  const double magnitude = std::abs(x) > 1 ? std::abs(x) : 1;
  return std::abs(x - nearest) <= 1e-9 * magnitude ? nearest : x;
}

template <Op op>
[[nodiscard]] inline double apply(double x) {
  if constexpr (op == Op::negate) return -x;
  if constexpr (op == Op::logical_not) return x == 0 ? 1 : 0;
  if constexpr (op == Op::floor) return std::floor(snap_to_integer(x));
  if constexpr (op == Op::ceil) return std::ceil(snap_to_integer(x));
  if constexpr (op == Op::round) return std::round(x);
  if constexpr (op == Op::abs) return std::abs(x);
  if constexpr (op == Op::sign) return x > 0 ? 1 : x < 0 ? -1 : 0;
  if constexpr (op == Op::sqrt) return std::sqrt(x);
  if constexpr (op == Op::exp) return std::exp(x);
  if constexpr (op == Op::log) return std::log(x);
  if constexpr (op == Op::sin) return std::sin(x);
  if constexpr (op == Op::cos) return std::cos(x);
  if constexpr (op == Op::tan) return std::tan(x);
  if constexpr (op == Op::asin) return std::asin(x);
  if constexpr (op == Op::acos) return std::acos(x);
  if constexpr (op == Op::atan) return std::atan(x);
}

template <Op op>
[[nodiscard]] inline double apply(double x, double y) {
  if constexpr (op == Op::add) return x + y;
  if constexpr (op == Op::subtract) return x - y;
  if constexpr (op == Op::multiply) return x * y;
  if constexpr (op == Op::divide) return x / y;
  if constexpr (op == Op::power) return std::pow(x, y);
  if constexpr (op == Op::less) return x < y ? 1 : 0;
  if constexpr (op == Op::less_equal) return x <= y ? 1 : 0;
  if constexpr (op == Op::greater) return x > y ? 1 : 0;
  if constexpr (op == Op::greater_equal) return x >= y ? 1 : 0;
  if constexpr (op == Op::equal) return x == y ? 1 : 0;
  if constexpr (op == Op::not_equal) return x != y ? 1 : 0;
  if constexpr (op == Op::mod) return x - y * apply<Op::floor>(x / y);
  // + 0.0 makes a positive zero of either zero; atan2 is the only operation that could tell them apart.
  if constexpr (op == Op::atan2) return std::atan2(x + 0.0, y + 0.0);
  if constexpr (op == Op::hypot) return std::hypot(x, y);
  if constexpr (op == Op::min) return y < x ? y : x;
  if constexpr (op == Op::max) return y > x ? y : x;
}

template <Op op>
[[nodiscard]] inline double apply(double x, double y, double z) {
  static_assert(op == Op::clamp);
  return apply<Op::min>(apply<Op::max>(x, y), z);
}

/// a number in [0, 1) that looks random and is the same everywhere. Every argument is rounded to an integer;
/// beyond 2^53 there is no value.
[[nodiscard]] inline double apply_hash(std::span<const double> arguments) {
  std::uint64_t h = 0;
  for (const double argument : arguments) {
    const double n = std::round(argument);
    if (!(std::abs(n) <= 0x1p53)) return std::numeric_limits<double>::quiet_NaN();
    // The step and the finisher of the SplitMix64 generator.
    h = (h ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(n))) + 0x9E3779B97F4A7C15U;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9U;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBU;
    h ^= h >> 31;
  }
  return static_cast<double>(h >> 11) * 0x1p-53;
}

}  // namespace meso::expr
