// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "meso/expr/expression.hpp"
#include "meso/expr/operations.hpp"

namespace meso::expr {
namespace {

Expression parsed(std::string_view text) {
  const ParseResult result = parse_expression(text, LengthUnit::millimeter);
  if (!result.expression) throw std::invalid_argument("no expression: " + std::string(text));
  return *result.expression;
}

double value(std::string_view text) {
  const EvalResult result = evaluate(parsed(text), {});
  return result ? result.value : std::nan("");
}

/// The subexpression that has no value, or "fine".
std::string domain_fault(std::string_view text) {
  const EvalResult result = evaluate(parsed(text), {});
  return result ? "fine" : std::string(text.substr(result.failed_offset, result.failed_length));
}

TEST(Evaluate, Arithmetic) {
  EXPECT_EQ(value("1 + 2 * 3 - 8 / 4"), 5);
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("0^0"), 1);
  EXPECT_EQ(value("1 - 2 - 3"), -4);
}

TEST(Evaluate, ComparisonsGiveOneOrZero) {
  EXPECT_EQ(value("1 < 2"), 1);
  EXPECT_EQ(value("2 <= 2"), 1);
  EXPECT_EQ(value("1 > 2"), 0);
  EXPECT_EQ(value("2 >= 3"), 0);
  EXPECT_EQ(value("0.1 + 0.2 == 0.3"), 0);
  EXPECT_EQ(value("0.1 + 0.2 != 0.3"), 1);
}

TEST(Evaluate, Logic) {
  EXPECT_EQ(value("5 and -2"), 1);
  EXPECT_EQ(value("5 and 0"), 0);
  EXPECT_EQ(value("0 and 5"), 0);
  EXPECT_EQ(value("0 or 7"), 1);
  EXPECT_EQ(value("7 or 0"), 1);
  EXPECT_EQ(value("0 or 0"), 0);
  EXPECT_EQ(value("not 0"), 1);
  EXPECT_EQ(value("not 0.1"), 0);
  EXPECT_EQ(value("0 or 3 and 4"), 1);
  EXPECT_FALSE(std::signbit(value("-0 and 1")));
}

TEST(Evaluate, Conditions) {
  EXPECT_EQ(value("1 ? 2 : 3"), 2);
  EXPECT_EQ(value("0 ? 2 : 3"), 3);
  EXPECT_EQ(value("0 ? 1 : 0 ? 2 : 3"), 3);
  EXPECT_EQ(value("(1 ? 0 ? 1 : 2 : 3) + 10"), 12);
}

TEST(Evaluate, FloorAndCeilForgiveRoundingNoise) {
  EXPECT_EQ(value("ceil(0.3 / 0.1)"), 3);  // 0.3 / 0.1 is 2.9999999999999996
  EXPECT_EQ(value("floor(0.3 / 0.1)"), 3);
  EXPECT_EQ(value("ceil(3 + 1e-10)"), 3);
  EXPECT_EQ(value("ceil(3 + 1e-8)"), 4);
  EXPECT_EQ(value("floor(3 - 1e-8)"), 2);
  EXPECT_EQ(value("floor(-0.5)"), -1);
  EXPECT_EQ(value("ceil(-0.5)"), 0);
  EXPECT_EQ(value("floor(1000000 - 1e-4)"), 1000000);  // within 1e-9 * 1e6
}

TEST(Evaluate, RoundsHalvesAwayFromZero) {
  EXPECT_EQ(value("round(0.5)"), 1);
  EXPECT_EQ(value("round(-0.5)"), -1);
  EXPECT_EQ(value("round(2.5)"), 3);
  EXPECT_EQ(value("round(0.49999999999999994)"), 0);
}

TEST(Evaluate, ModHasTheSignOfTheDivisor) {
  EXPECT_EQ(value("mod(7, 3)"), 1);
  EXPECT_EQ(value("mod(-7, 3)"), 2);
  EXPECT_EQ(value("mod(7, -3)"), -2);
  EXPECT_NEAR(value("mod(0.3, 0.1)"), 0, 1e-15);
}

TEST(Evaluate, Functions) {
  EXPECT_EQ(value("abs(-3)"), 3);
  EXPECT_EQ(value("sign(-3) + 10 * sign(0) + 100 * sign(4)"), 99);
  EXPECT_EQ(value("sqrt(9)"), 3);
  EXPECT_EQ(value("hypot(3, 4)"), 5);
  EXPECT_DOUBLE_EQ(value("exp(1)"), std::numbers::e);
  EXPECT_DOUBLE_EQ(value("log(10)"), std::numbers::ln10);
  EXPECT_DOUBLE_EQ(value("sin(30deg)"), 0.5);
  EXPECT_DOUBLE_EQ(value("cos(60deg)"), 0.5);
  EXPECT_DOUBLE_EQ(value("tan(45deg)"), 1);
  EXPECT_DOUBLE_EQ(value("asin(1)"), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(value("acos(-1)"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(value("atan(1) * 4"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(value("atan2(1, -1) / 135deg"), 1);
  EXPECT_EQ(value("min(3, 1, 2) + 10 * max(3, 1, 7, 2) + 100 * min(5)"), 571);
  EXPECT_EQ(value("clamp(5, 0, 3) + clamp(-5, 1, 3) + clamp(2, 0, 3)"), 6);
  EXPECT_EQ(value("clamp(1, 3, 2)"), 2);
}

TEST(Evaluate, ZeroHasOneSign) {
  EXPECT_EQ(value("atan2(0, -1)"), std::numbers::pi);
  EXPECT_EQ(value("atan2(-0, -1)"), std::numbers::pi);
  EXPECT_EQ(value("atan2(0, -0)"), 0);
}

// Values of an independent implementation of section 7.5's text in Python integers.
TEST(Evaluate, HashIsTheSameEverywhere) {
  EXPECT_EQ(value("hash(0)"), 0.8833108082136426);
  EXPECT_EQ(value("hash(1, 2, 3, 4)"), 0.8334472949893438);
  EXPECT_EQ(value("hash(-1, 2.5)"), 0.011382352467864343);
  EXPECT_EQ(value("hash(9007199254740992)"), 0.8076686994283997);
  EXPECT_EQ(domain_fault("1 + hash(1, 9007199254740994)"), "hash(1, 9007199254740994)");
}

TEST(Evaluate, HashIsEven) {
  double sum = 0;
  int low = 0;
  const Expression hash = parsed("hash(i, j)");
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const std::array<double, 2> slots = {static_cast<double>(i), static_cast<double>(j)};
      const double h = evaluate(hash, slots).value;
      ASSERT_TRUE(h >= 0 && h < 1);
      sum += h;
      low += h < 0.1 ? 1 : 0;
    }
  EXPECT_NEAR(sum / 10000, 0.5, 0.015);  // five standard deviations of the mean of 10000 uniform numbers
  EXPECT_NEAR(low, 1000, 150);
}

TEST(Domain, EveryOperationIsWatched) {
  EXPECT_EQ(domain_fault("1 / 0"), "1 / 0");
  EXPECT_EQ(domain_fault("0/0 + 1"), "0/0");
  EXPECT_EQ(domain_fault("1e308 + 1e308"), "1e308 + 1e308");
  EXPECT_EQ(domain_fault("-1e308 - 1e308"), "-1e308 - 1e308");
  EXPECT_EQ(domain_fault("2 * (1e200 * 1e200)"), "1e200 * 1e200");
  EXPECT_EQ(domain_fault("(-8)^(1/3)"), "(-8)^(1/3)");
  EXPECT_EQ(domain_fault("0^-1"), "0^-1");
  for (const char* call : {"sqrt(-1)", "log(0)", "log(-1)", "exp(1000)", "asin(1.1)", "acos(-1.1)", "mod(1, 0)",
                           "hypot(1.5e308, 1.5e308)"})
    EXPECT_EQ(domain_fault("2 + " + std::string(call)), call);
}

TEST(Domain, NothingHidesIt) {
  EXPECT_EQ(domain_fault("min(1/0, 5)"), "1/0");
  EXPECT_EQ(domain_fault("(1/0) < 5"), "1/0");
  EXPECT_EQ(domain_fault("0 * (1/0)"), "1/0");
  EXPECT_EQ(domain_fault("not (1/0)"), "1/0");
  EXPECT_EQ(domain_fault("(0/0) ? 1 : 2"), "0/0");
}

TEST(Domain, UntakenBranchesAreNotEvaluated) {
  EXPECT_EQ(domain_fault("1 ? 2 : 1/0"), "fine");
  EXPECT_EQ(domain_fault("0 ? 1/0 : 2"), "fine");
  EXPECT_EQ(domain_fault("0 and 1/0"), "fine");
  EXPECT_EQ(domain_fault("1 or 1/0"), "fine");
  EXPECT_EQ(domain_fault("1 and 1/0"), "1/0");
  EXPECT_EQ(domain_fault("0 or 1/0"), "1/0");
  EXPECT_EQ(domain_fault("0 ? 1 : 0 ? 1/0 : sqrt(-1)"), "sqrt(-1)");
  EXPECT_EQ(domain_fault("0 and 1/0 or 1 or 1/0"), "fine");
}

TEST(Slots, FollowTheNames) {
  const Expression e = parsed("b - a + b");
  EXPECT_EQ(evaluate(e, std::array<double, 2>{5, 3}).value, 7);
  const std::array<std::uint32_t, 2> slots = {2, 0};
  const Expression bound = e.bind(slots);
  EXPECT_EQ(evaluate(bound, std::array<double, 3>{1, 99, 10}).value, 19);
  EXPECT_EQ(bound.names()[0].slot, 2);
}

TEST(Slots, MayBeSharedAndBoundAgain) {
  const Expression e = parsed("a - b");
  const std::array<std::uint32_t, 2> same = {1, 1};
  const std::array<std::uint32_t, 2> swapped = {1, 0};
  EXPECT_EQ(evaluate(e.bind(same), std::array<double, 2>{5, 3}).value, 0);
  EXPECT_EQ(evaluate(e.bind(same).bind(swapped), std::array<double, 2>{5, 3}).value, -2);
}

TEST(Depth, TheDeepestExpressionFitsTheStack) {
  std::string text = "1";
  for (std::size_t i = 0; i < max_nesting; ++i) text.insert(0, "hash(1,1,1,1,1,1,1,0<0+1*").append(")");
  EXPECT_TRUE(evaluate(parsed(text), {}));
}

TEST(Depth, LongSumsDoNotNest) {
  std::string text = "1";
  for (int i = 0; i < 30000; ++i) text += "+1";
  EXPECT_EQ(value(text), 30001);
}

}  // namespace
}  // namespace meso::expr
