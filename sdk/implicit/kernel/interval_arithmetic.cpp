// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/interval_arithmetic.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <numbers>

#include "meso/expr/operations.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

constexpr double infinity = HUGE_VAL;
constexpr double pi = std::numbers::pi;
constexpr int elementary_ulps = 8;
// sin, cos and tan near their zeros: an implementation may be exact only to the rounding of its argument's reduction.
constexpr double trigonometric_slack = 1e-15;

const Interval nowhere{0, 0, true};

/// At least `ulps` steps below v; what is infinite may be a finite value that overflowed.
double below(double v, int ulps = 1) {
  if (v == infinity) return DBL_MAX;
  return v == -infinity ? v : v - (std::abs(v) * (ulps * DBL_EPSILON) + DBL_TRUE_MIN);
}
double above(double v, int ulps = 1) { return -below(-v, ulps); }

bool contains_zero(Interval x) { return x.lo <= 0 && x.hi >= 0; }
bool may_be_infinite(Interval x) { return x.lo == -infinity || x.hi == infinity; }
double magnitude(Interval x) { return std::max(std::abs(x.lo), std::abs(x.hi)); }
double mignitude(Interval x) { return contains_zero(x) ? 0 : std::min(std::abs(x.lo), std::abs(x.hi)); }
Interval absolute(Interval x) { return {mignitude(x), magnitude(x), x.undefined}; }
bool is_point(Interval x) { return x.lo == x.hi; }
Interval negated(Interval x) { return {-x.hi, -x.lo, x.undefined}; }

/// Truth of a condition: NaN is not 0, so it is true.
bool may_be_true(Interval x) { return x.lo != 0 || x.hi != 0 || x.undefined; }
bool may_be_false(Interval x) { return contains_zero(x); }
Interval truth(bool may_hold, bool may_fail) { return {may_fail ? 0.0 : 1.0, may_hold ? 1.0 : 0.0, false}; }

/// The rounding error of the sum s = a + b (Knuth's TwoSum); 0 only if s is exact.
double sum_error(double a, double b, double s) {
  const double b_part = s - a;
  return (a - (s - b_part)) + (b - b_part);
}

Interval add(Interval a, Interval b) {
  double lo = a.lo + b.lo, hi = a.hi + b.hi;
  if (std::isnan(lo)) lo = -infinity;
  if (std::isnan(hi)) hi = infinity;
  if (sum_error(a.lo, b.lo, lo) != 0) lo = below(lo);
  if (sum_error(a.hi, b.hi, hi) != 0) hi = above(hi);
  const bool cancels = (a.hi == infinity && b.lo == -infinity) || (a.lo == -infinity && b.hi == infinity);
  return {lo, hi, a.undefined || b.undefined || cancels};
}

/// The hull of a function's values at the four corners; corners without a value are those of infinities that meet.
template <class F>
Interval of_corners(Interval a, Interval b, bool undefined, F f) {
  Interval r{infinity, -infinity, undefined};
  for (const double x : {a.lo, a.hi})
    for (const double y : {b.lo, b.hi}) {
      const auto [lo, hi] = f(x, y);
      if (std::isnan(lo)) continue;
      r.lo = std::min(r.lo, lo);
      r.hi = std::max(r.hi, hi);
    }
  return r.lo <= r.hi ? r : nowhere;
}

Interval multiply(Interval a, Interval b) {
  const bool undefined = a.undefined || b.undefined || (contains_zero(a) && may_be_infinite(b)) ||
                         (contains_zero(b) && may_be_infinite(a));
  return of_corners(a, b, undefined, [](double x, double y) {
    const double v = x * y;
    return x == 0 || y == 0 ? std::pair(v, v) : std::pair(below(v), above(v));
  });
}

/// A zero may have either sign, so a quotient by it either infinity.
Interval divide(Interval a, Interval b) {
  const bool undefined = a.undefined || b.undefined || (may_be_infinite(a) && may_be_infinite(b));
  if (contains_zero(b)) return {-infinity, infinity, undefined || contains_zero(a)};
  return of_corners(a, b, undefined, [](double x, double y) {
    const double v = x / y;
    return x == 0 ? std::pair(v, v) : std::pair(below(v), above(v));
  });
}

/// A function that never decreases, exact to `ulps` and `slack`.
template <class F>
Interval rising(Interval x, F f, int ulps = elementary_ulps, double slack = 0) {
  const double lo = f(x.lo), hi = f(x.hi);
  return {ulps == 0 ? lo : below(lo, ulps) - slack, ulps == 0 ? hi : above(hi, ulps) + slack, x.undefined};
}

/// x limited to where a function has values; nowhere() if that is nothing.
bool limit(Interval& x, double lo, double hi) {
  if (x.lo < lo || x.hi > hi) x.undefined = true;
  x.lo = std::max(x.lo, lo);
  x.hi = std::min(x.hi, hi);
  return x.lo <= x.hi;
}
Interval clipped(Interval x, double lo, double hi) { return {std::max(x.lo, lo), std::min(x.hi, hi), x.undefined}; }

Interval square_root(Interval x) {
  if (!limit(x, 0, infinity)) return nowhere;
  return clipped(rising(
                     x, [](double v) { return std::sqrt(v); }, 1),
                 0, infinity);
}

Interval logarithm(Interval x) {
  if (!limit(x, 0, infinity)) return nowhere;
  return rising(x, [](double v) { return std::log(v); });
}

Interval arc_sine(Interval x) {
  if (!limit(x, -1, 1)) return nowhere;
  return rising(x, [](double v) { return std::asin(v); });
}

/// Is there a whole number n with phase + n * period in x, or nearly?
bool meets(Interval x, double phase, double period) {
  const double slack = 4 * DBL_EPSILON * (magnitude(x) + period);
  const double n = std::ceil((x.lo - phase - slack) / period);
  return phase + n * period <= x.hi + slack;
}

/// sin if phase is pi / 2, cos if it is 0: the place of a maximum.
template <class F>
Interval wave(Interval x, double phase, F f) {
  if (may_be_infinite(x)) return {-1, 1, true};
  if (!(magnitude(x) < 1e9) || x.hi - x.lo >= 2 * pi) return {-1, 1, x.undefined};
  const double a = f(x.lo), b = f(x.hi);
  const double margin = trigonometric_slack;
  const double hi = meets(x, phase, 2 * pi) ? 1 : std::max(a, b) + margin;
  const double lo = meets(x, phase + pi, 2 * pi) ? -1 : std::min(a, b) - margin;
  return clipped({lo, hi, x.undefined}, -1, 1);
}

Interval tangent(Interval x) {
  if (may_be_infinite(x)) return {-infinity, infinity, true};
  if (!(magnitude(x) < 1e9) || meets(x, pi / 2, pi)) return {-infinity, infinity, x.undefined};
  return rising(
      x, [](double v) { return std::tan(v); }, elementary_ulps, trigonometric_slack);
}

Interval arc_tangent2(Interval y, Interval x) {
  const bool undefined = x.undefined || y.undefined;
  if (x.lo < 0 && y.lo < 0 && y.hi >= 0) return {-above(pi), above(pi), undefined};
  return of_corners(y, x, undefined, [](double v, double u) {
    const double angle = expr::apply<Op::atan2>(v, u);
    return std::pair(below(angle, elementary_ulps), above(angle, elementary_ulps));
  });
}

Interval hypotenuse(Interval x, Interval y) {
  const double lo = std::hypot(mignitude(x), mignitude(y)), hi = std::hypot(magnitude(x), magnitude(y));
  return {std::max(0.0, below(lo, elementary_ulps)), above(hi, elementary_ulps), x.undefined || y.undefined};
}

Interval power_of_positive(Interval x, Interval y) {
  return of_corners(x, y, x.undefined || y.undefined, [](double base, double exponent) {
    const double v = std::pow(base, exponent);
    return std::pair(std::max(0.0, below(v, elementary_ulps)), above(v, elementary_ulps));
  });
}

Interval power(Interval x, Interval y) {
  const bool undefined = x.undefined || y.undefined;
  const bool whole = is_point(y) && y.lo == std::round(y.lo) && std::abs(y.lo) < 0x1p53;
  Interval r;
  if (contains_zero(x) && y.lo < 0 && !(whole && std::fmod(y.lo, 2) == 0)) {
    r = {-infinity, infinity, undefined || (x.lo < 0 && !whole)};
  } else if (x.lo >= 0) {
    r = power_of_positive(x, y);
  } else if (is_point(y) && y.lo != std::round(y.lo) && x.lo > -infinity) {
    if (!limit(x, 0, infinity)) return hull(nowhere, {1, 1, true});
    r = power_of_positive(x, y);
  } else if (!whole) {
    // Where y happens to be whole there is a value of either sign; elsewhere there is none for a negative base.
    const double reach = power_of_positive(absolute(x), y).hi;
    r = {-reach, reach, true};
  } else if (std::fmod(y.lo, 2) == 0) {
    r = power_of_positive(absolute(x), y);
  } else {
    const double a = std::pow(x.lo, y.lo), b = std::pow(x.hi, y.lo);  // rising, or falling away from zero
    r = {below(std::min(a, b), elementary_ulps), above(std::max(a, b), elementary_ulps), undefined};
  }
  // pow(1, NaN) and pow(NaN, 0) are 1.
  return undefined ? hull(r, {1, 1, true}) : r;
}

Interval floor_of(Interval x) {
  return rising(
      x, [](double v) { return expr::apply<Op::floor>(v); }, 0);
}

Interval modulo(Interval x, Interval y) {
  if (contains_zero(y) || may_be_infinite(x) || may_be_infinite(y)) return Interval::everything();
  const Interval quotient = divide(x, y);
  if (may_be_infinite(quotient)) return Interval::everything();
  const Interval whole = floor_of(quotient);
  Interval r = add(x, negated(multiply(y, whole)));
  // x - y n lies between 0 and y, but for what floor forgives (1e-9 of the quotient, never more than half) and for
  // rounding the quotient and the product.
  const double reach = magnitude(y);
  const double forgiven = std::min(0.5, 1e-9 * std::max(1.0, magnitude(quotient))) * reach;
  const double slack = above(forgiven, 4) + 8 * DBL_EPSILON * (magnitude(x) + reach);
  const double least = (y.hi > 0 ? 0 : -reach) - slack, most = (y.hi > 0 ? reach : 0) + slack;
  return clipped(r, least, most);
}

Interval hash_of(std::span<const Interval> operands) {
  std::array<double, 8> arguments{};
  bool known = true, undefined = false;
  for (std::size_t i = 0; i < operands.size(); ++i) {
    arguments[i] = std::round(operands[i].lo);
    known = known && arguments[i] == std::round(operands[i].hi) && !operands[i].undefined;
    undefined = undefined || operands[i].undefined || !(magnitude(operands[i]) < 0x1p53);
  }
  if (!known || undefined) return {0, 1, undefined};
  const double v = expr::apply_hash({arguments.data(), operands.size()});
  return {v, v, false};
}

/// apply<min> gives its first operand if either is NaN.
Interval minimum(Interval a, Interval b) {
  const Interval r{std::min(a.lo, b.lo), std::min(a.hi, b.hi), a.undefined};
  return b.undefined ? hull(r, a) : r;
}
Interval maximum(Interval a, Interval b) { return negated(minimum(negated(a), negated(b))); }

Interval selected(std::span<const Interval> v) {
  switch (choice_of(Op::select, v)) {
    case Choice::first:
      return v[1];
    case Choice::second:
      return v[2];
    default:
      return hull(v[1], v[2]);
  }
}

Interval sign_of(Interval x) {
  const auto sign = [](double v) { return expr::apply<Op::sign>(v); };
  const Interval r{sign(x.lo), sign(x.hi), false};
  return x.undefined ? hull(r, {0, 0, false}) : r;  // of NaN it is 0
}

Interval compared(Op op, Interval a, Interval b) {
  const bool unknown = a.undefined || b.undefined;  // NaN: unequal, and every other comparison fails
  switch (op) {
    case Op::less:
      return truth(a.lo < b.hi, !(a.hi < b.lo) || unknown);
    case Op::less_equal:
      return truth(a.lo <= b.hi, !(a.hi <= b.lo) || unknown);
    case Op::equal:
      return truth(a.lo <= b.hi && b.lo <= a.hi, !(is_point(a) && is_point(b) && a.lo == b.lo) || unknown);
    default:
      assert(!"a comparison");
      return {0, 1, false};
  }
}

Interval of_one(Op op, Interval x) {
  switch (op) {
    case Op::negate:
      return negated(x);
    case Op::logical_not:
      return truth(may_be_false(x), may_be_true(x));
    case Op::floor:
      return floor_of(x);
    case Op::ceil:
      return rising(
          x, [](double v) { return expr::apply<Op::ceil>(v); }, 0);
    case Op::round:
      return rising(
          x, [](double v) { return std::round(v); }, 0);
    case Op::abs:
      return absolute(x);
    case Op::sign:
      return sign_of(x);
    case Op::sqrt:
      return square_root(x);
    case Op::exp:
      return clipped(rising(x, [](double v) { return std::exp(v); }), 0, infinity);
    case Op::log:
      return logarithm(x);
    case Op::sin:
      return wave(x, pi / 2, [](double v) { return std::sin(v); });
    case Op::cos:
      return wave(x, 0, [](double v) { return std::cos(v); });
    case Op::tan:
      return tangent(x);
    case Op::asin:
      return arc_sine(x);
    case Op::acos:
      return clipped(add({pi / 2, above(pi / 2), false}, negated(arc_sine(x))), 0, above(pi));
    case Op::atan:
      return rising(x, [](double v) { return std::atan(v); });
    default:
      assert(!"an operation of one operand");
      return Interval::everything();
  }
}

}  // namespace

Interval hull(Interval a, Interval b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), a.undefined || b.undefined};
}

Interval square(Interval x) {
  const double least = mignitude(x), most = magnitude(x);
  return {least == 0 ? 0 : std::max(0.0, below(least * least)), most == 0 ? 0 : above(most * most), x.undefined};
}

Choice choice_of(Op op, std::span<const Interval> v) {
  switch (op) {
    case Op::min:  // if the first is NaN so is the result; if the second is, the result is the first
      if (v[0].hi <= v[1].lo) return Choice::first;
      return v[1].hi < v[0].lo && !v[0].undefined && !v[1].undefined ? Choice::second : Choice::none;
    case Op::max:
      if (v[0].lo >= v[1].hi) return Choice::first;
      return v[1].lo > v[0].hi && !v[0].undefined && !v[1].undefined ? Choice::second : Choice::none;
    case Op::select:
      if (!may_be_false(v[0])) return Choice::first;
      return !may_be_true(v[0]) ? Choice::second : Choice::none;
    default:
      return Choice::none;
  }
}

Interval interval_of(Op op, std::span<const Interval> v) {
  switch (op) {
    case Op::add:
      return add(v[0], v[1]);
    case Op::subtract:
      return add(v[0], negated(v[1]));
    case Op::multiply:
      return multiply(v[0], v[1]);
    case Op::divide:
      return divide(v[0], v[1]);
    case Op::power:
      return power(v[0], v[1]);
    case Op::less:
    case Op::less_equal:
    case Op::equal:
      return compared(op, v[0], v[1]);
    case Op::greater:
      return compared(Op::less, v[1], v[0]);
    case Op::greater_equal:
      return compared(Op::less_equal, v[1], v[0]);
    case Op::not_equal:
      return of_one(Op::logical_not, compared(Op::equal, v[0], v[1]));
    case Op::mod:
      return modulo(v[0], v[1]);
    case Op::atan2:
      return arc_tangent2(v[0], v[1]);
    case Op::hypot:
      return hypotenuse(v[0], v[1]);
    case Op::min:
      return minimum(v[0], v[1]);
    case Op::max:
      return maximum(v[0], v[1]);
    case Op::clamp:
      return minimum(maximum(v[0], v[1]), v[2]);
    case Op::hash:
      return hash_of(v);
    case Op::logical_and:
      return truth(may_be_true(v[0]) && may_be_true(v[1]), may_be_false(v[0]) || may_be_false(v[1]));
    case Op::logical_or:
      return truth(may_be_true(v[0]) || may_be_true(v[1]), may_be_false(v[0]) && may_be_false(v[1]));
    case Op::select:
      return selected(v);
    default:
      return of_one(op, v[0]);
  }
}

}  // namespace meso::implicit
