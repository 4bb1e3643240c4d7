// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/interval_arithmetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "scalar_operation.hpp"

namespace meso::implicit {
namespace {

using expr::Op;
constexpr double pi = std::numbers::pi;

struct Case {
  Op op;
  std::size_t operands;
};
const Case all_operations[] = {
    {Op::negate, 1}, {Op::logical_not, 1}, {Op::floor, 1},      {Op::ceil, 1},     {Op::round, 1},
    {Op::abs, 1},    {Op::sign, 1},        {Op::sqrt, 1},       {Op::exp, 1},      {Op::log, 1},
    {Op::sin, 1},    {Op::cos, 1},         {Op::tan, 1},        {Op::asin, 1},     {Op::acos, 1},
    {Op::atan, 1},   {Op::add, 2},         {Op::subtract, 2},   {Op::multiply, 2}, {Op::divide, 2},
    {Op::power, 2},  {Op::less, 2},        {Op::less_equal, 2}, {Op::greater, 2},  {Op::greater_equal, 2},
    {Op::equal, 2},  {Op::not_equal, 2},   {Op::mod, 2},        {Op::atan2, 2},    {Op::hypot, 2},
    {Op::min, 2},    {Op::max, 2},         {Op::clamp, 3},      {Op::hash, 1},     {Op::hash, 3},
    {Op::select, 3}, {Op::logical_and, 2}, {Op::logical_or, 2},
};

/// Intervals of all the kinds that matter: points, small, wide, with zero at an end or inside, whole numbers, infinite.
class RandomInterval {
 public:
  Interval operator()() {
    const double scale = std::exp2(uniform(-20, 12));
    double a = uniform(-1, 1) * scale, b = a;
    switch (pick(8)) {
      case 0:
        a = b = std::round(uniform(-6, 6));
        break;
      case 1:
        b = a + std::abs(a) * 1e-12;
        break;
      case 2:
        a = 0;
        break;
      case 3:
        a = std::round(uniform(-5, 5));
        b = a + std::round(uniform(0, 3));
        break;
      case 4:
        a = std::round(a) - 1e-10;
        b = std::round(a) + 1e-10;
        break;
      case 5:
        (pick(2) == 0 ? a : b) = pick(2) == 0 ? HUGE_VAL : -HUGE_VAL;
        break;
      default:
        b = a + uniform(0, 2) * scale;
    }
    if (a > b) std::swap(a, b);
    return {a, b, pick(5) == 0};
  }

  double inside(Interval x) {
    if (x.undefined && pick(4) == 0) return NAN;
    switch (pick(4)) {
      case 0:
        return x.lo;
      case 1:
        return x.hi;
      case 2:
        if (x.lo <= 0 && x.hi >= 0) return pick(2) == 0 ? 0.0 : -0.0;
        [[fallthrough]];
      default: {
        const double lo = std::max(x.lo, -1e300), hi = std::min(x.hi, 1e300);
        if (!(lo <= hi)) return x.lo;
        const double v = lo + (hi - lo) * uniform(0, 1);
        const double rounded = std::round(v);
        return pick(3) == 0 && x.contains(rounded) ? rounded : std::clamp(v, x.lo, x.hi);
      }
    }
  }

 private:
  double uniform(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(engine_); }
  int pick(int n) { return std::uniform_int_distribution(0, n - 1)(engine_); }
  std::mt19937_64 engine_{20240607};
};

TEST(IntervalArithmetic, HoldsEveryValueOfEveryOperation) {
  RandomInterval random;
  for (const Case& c : all_operations) {
    for (int round = 0; round < 4000; ++round) {
      std::array<Interval, 3> box;
      std::array<double, 3> point{};
      for (std::size_t k = 0; k < c.operands; ++k) box[k] = random();
      const Interval range = interval_of(c.op, {box.data(), c.operands});
      ASSERT_LE(range.lo, range.hi) << int(c.op);
      for (int sample = 0; sample < 8; ++sample) {
        for (std::size_t k = 0; k < c.operands; ++k) point[k] = random.inside(box[k]);
        const double v = apply_operation(c.op, {point.data(), c.operands});
        ASSERT_TRUE(range.contains(v)) << "operation " << int(c.op) << " of " << point[0] << ", " << point[1] << ", "
                                       << point[2] << " is " << v << ", not in " << range.lo << " ... " << range.hi
                                       << "\nfirst operand " << box[0].lo << " ... " << box[0].hi << ", second "
                                       << box[1].lo << " ... " << box[1].hi;
      }
    }
  }
}

// Otherwise "everything" would be a good answer to all questions. The yardstick: samples on a fine grid.
TEST(IntervalArithmetic, IsTightForOperationsOfBoundedOperands) {
  RandomInterval random;
  for (const Case& c : all_operations) {
    if (c.op == Op::hash) continue;
    for (int round = 0; round < 60; ++round) {
      std::array<Interval, 3> box;
      for (std::size_t k = 0; k < c.operands; ++k) {
        box[k] = random();
        box[k].undefined = false;
      }
      const Interval range = interval_of(c.op, {box.data(), c.operands});
      if (std::any_of(box.begin(), box.begin() + c.operands, [](Interval b) { return std::isinf(b.hi - b.lo); }))
        continue;
      if (c.op == Op::atan2 && box[0].lo < 0 && box[0].hi >= 0 && box[1].lo < 0) continue;  // the cut: hard to sample
      if (!(std::isfinite(range.lo) && std::isfinite(range.hi)) || range.undefined) continue;
      double lo = HUGE_VAL, hi = -HUGE_VAL, reach = 0;
      const int n = c.operands == 1 ? 20000 : c.operands == 2 ? 200 : 24;
      std::array<int, 3> i{};
      for (i[0] = 0; i[0] <= n; ++i[0])
        for (i[1] = 0; i[1] <= (c.operands > 1 ? n : 0); ++i[1])
          for (i[2] = 0; i[2] <= (c.operands > 2 ? n : 0); ++i[2]) {
            std::array<double, 3> p{};
            for (std::size_t k = 0; k < 3; ++k) {
              p[k] = i[k] == n ? box[k].hi : box[k].lo + (box[k].hi - box[k].lo) * i[k] / n;
              if (i[k] == n / 2 && box[k].contains(0)) p[k] = 0;
              reach = std::max(reach, k < c.operands ? std::abs(p[k]) : 0);
            }
            const double v = apply_operation(c.op, {p.data(), c.operands});
            lo = std::min(lo, v);
            hi = std::max(hi, v);
          }
      if (c.op == Op::equal || c.op == Op::not_equal || c.op == Op::mod || c.op == Op::select) continue;
      const double tolerance = 0.03 * (range.hi - range.lo) + 1e-9 * (1 + reach);
      EXPECT_NEAR(range.lo, lo, tolerance) << int(c.op) << " of " << box[0].lo << " ... " << box[0].hi;
      EXPECT_NEAR(range.hi, hi, tolerance) << int(c.op) << " of " << box[0].lo << " ... " << box[0].hi;
    }
  }
}

Interval of(Op op, std::initializer_list<Interval> v) { return interval_of(op, std::vector<Interval>(v)); }

TEST(IntervalArithmetic, KnowsWhereWavesTurn) {
  EXPECT_EQ(of(Op::sin, {{1, 2}}).hi, 1);
  EXPECT_NEAR(of(Op::sin, {{1, 2}}).lo, std::sin(1), 1e-14);
  EXPECT_EQ(of(Op::cos, {{3, 4}}).lo, -1);
  EXPECT_NEAR(of(Op::cos, {{101 * pi - 0.1, 101 * pi + 0.2}}).hi, -std::cos(0.2), 1e-12);
  EXPECT_TRUE(std::isinf(of(Op::tan, {{1, 2}}).hi));
  EXPECT_NEAR(of(Op::tan, {{2, 4}}).hi, std::tan(4), 1e-12);
  EXPECT_TRUE(of(Op::sin, {{0, HUGE_VAL}}).undefined);
}

TEST(IntervalArithmetic, SaysWhereThereIsNoValue) {
  EXPECT_TRUE(of(Op::sqrt, {{-1, 4}}).undefined);
  EXPECT_EQ(of(Op::sqrt, {{-1, 4}}).lo, 0);
  EXPECT_FALSE(of(Op::sqrt, {{0, 4}}).undefined);
  EXPECT_TRUE(of(Op::log, {{-2, -1}}).all_outside());  // nowhere defined: outside everywhere
  EXPECT_TRUE(of(Op::divide, {{0, 1}, {-1, 1}}).undefined);
  EXPECT_FALSE(of(Op::divide, {{1, 2}, {-1, 1}}).undefined);  // infinite, but a value
  EXPECT_TRUE(of(Op::power, {{-1, 1}, {0.5, 0.5}}).undefined);
  EXPECT_FALSE(of(Op::power, {{-2, 3}, {3, 3}}).undefined);
  EXPECT_TRUE(of(Op::hash, {{0, 1e300}}).undefined);
}

TEST(IntervalArithmetic, ComparesWithNoValue) {
  const Interval unknown{1, 2, true};
  EXPECT_EQ(of(Op::less, {unknown, {3, 4}}), (Interval{0, 1, false}));
  EXPECT_EQ(of(Op::less, {{1, 2}, {3, 4}}), (Interval{1, 1, false}));
  EXPECT_EQ(of(Op::not_equal, {unknown, {3, 4}}), (Interval{1, 1, false}));
  EXPECT_EQ(of(Op::select, {unknown, {5, 6}, {8, 9}}), (Interval{5, 6, false}));  // NaN is not 0
}

TEST(IntervalArithmetic, ChoosesOnlyWhatIsCertain) {
  const auto choice = [](Op op, std::initializer_list<Interval> v) { return choice_of(op, std::vector<Interval>(v)); };
  EXPECT_EQ(choice(Op::min, {{0, 1}, {1, 2}}), Choice::first);
  EXPECT_EQ(choice(Op::min, {{0, 1}, {1, 2, true}}), Choice::first);  // min(a, NaN) is a
  EXPECT_EQ(choice(Op::min, {{3, 4}, {1, 2}}), Choice::second);
  EXPECT_EQ(choice(Op::min, {{3, 4, true}, {1, 2}}), Choice::none);
  EXPECT_EQ(choice(Op::min, {{0, 3}, {1, 2}}), Choice::none);
  EXPECT_EQ(choice(Op::max, {{0, 1}, {2, 3}}), Choice::second);
  EXPECT_EQ(choice(Op::select, {{0, 0}, {2, 3}, {4, 5}}), Choice::second);
  EXPECT_EQ(choice(Op::add, {{0, 1}, {1, 2}}), Choice::none);
}

TEST(IntervalArithmetic, SquaresAreNotNegative) {
  EXPECT_EQ(square({-2, 1}).lo, 0);
  EXPECT_NEAR(square({-2, 1}).hi, 4, 1e-14);
  EXPECT_GT(square({1e-3, 1}).lo, 0);
}

TEST(IntervalArithmetic, RoundsOutwards) {
  const Interval third = of(Op::divide, {{1, 1}, {3, 3}});
  EXPECT_LT(third.lo, 1.0 / 3);
  EXPECT_GT(third.hi, 1.0 / 3);
  EXPECT_EQ(of(Op::add, {{1, 2}, {3, 4}}), (Interval{4, 6, false}));  // exact sums stay
  EXPECT_GT(of(Op::add, {{0.1, 0.1}, {0.2, 0.2}}).hi, 0.1 + 0.2);
}

}  // namespace
}  // namespace meso::implicit
