// SPDX-License-Identifier: Apache-2.0
#pragma once
// What an operation can give when its operands lie in intervals: the arithmetic with which boxes are shown to be empty
// or full. A function of the operation and its operands' intervals, so that any tape can use it.
//
//   const Interval x{-1, 2}, two{2, 2}, operands[] = {x, two};
//   interval_of(expr::Op::add, operands)       // [1, 4]
//   square(x)                                  // [0, 4]; multiply would have to say [-2, 4]
//
// Bounds are rounded outwards and allow for 8 units in the last place of every elementary function, so that they hold
// for real numbers and for any implementation that is as exact. Infinite ends mean that the value may be infinite:
// infinity minus infinity is `undefined`. Operations that have no value anywhere in a box give {0, 0, undefined}.

#include <cstdint>
#include <span>

#include "meso/expr/expression.hpp"
#include "meso/implicit/interval.hpp"

namespace meso::implicit {

/// REQUIRES: as many operands as `op` takes; an operation with operands, not a leaf and not a skip.
[[nodiscard]] Interval interval_of(expr::Op op, std::span<const Interval> operands);

/// multiply where both operands are the same value.
[[nodiscard]] Interval square(Interval x);

/// Which operand of min, max or select the result always equals in these intervals, so that a tape can leave the other
/// one out. `none`: it depends, or `op` is no choice.
enum class Choice : std::uint8_t { none, first, second };
/// For select, `first` and `second` are the two branches.
[[nodiscard]] Choice choice_of(expr::Op op, std::span<const Interval> operands);

/// The smallest interval that holds both.
[[nodiscard]] Interval hull(Interval a, Interval b);

}  // namespace meso::implicit
