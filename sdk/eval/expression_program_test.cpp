// SPDX-License-Identifier: Apache-2.0
#include "expression_program.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <clocale>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>

namespace meso::eval {
namespace {

expr::Expression parsed(const std::string& text) {
  const expr::ParseResult result = expr::parse_expression(text, LengthUnit::millimeter);
  if (!result.expression) throw std::invalid_argument("no expression: " + text);
  return *result.expression;
}

double value(const std::string& text) { return ExpressionProgram(parsed(text)).evaluate({}).value; }

/// Grows random texts of the grammar; depth bounds them.
class Grower {
 public:
  explicit Grower(std::uint64_t seed) : random_(seed) {}

  std::string expression(int depth) {
    if (depth == 0) return leaf();
    const auto sub = [&] { return "(" + expression(depth - 1) + ")"; };
    switch (random_() % 8) {
      case 0:
        return leaf();
      case 1:
        return pick({"-", "not "}) + sub();
      case 2:
        return sub() + pick({"+", "-", "*", "/", "^", "+", "-", "*"}) + sub();
      case 3:
        return sub() + pick({"<", "<=", ">", ">=", "==", "!="}) + sub();
      case 4:
        return sub() + pick({" and ", " or "}) + sub();
      case 5:
        return sub() + "?" + expression(depth - 1) + ":" + expression(depth - 1);
      case 6:
        return pick({"floor", "ceil", "round", "abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos",
                     "atan"}) +
               sub();
      default:
        return call(depth);
    }
  }
  std::uint64_t operator()() { return random_(); }

 private:
  std::string leaf() { return pick({"a", "b", "c.d", "0", "1", "2.5", "0.1mm", "30deg", "pi", "1e200"}); }
  std::string call(int depth) {
    const auto list = [&](std::size_t n) {
      std::string out = expression(depth - 1);
      while (--n > 0) out += ", " + expression(depth - 1);
      return "(" + out + ")";
    };
    switch (random_() % 4) {
      case 0:
        return pick({"mod", "atan2", "hypot"}) + list(2);
      case 1:
        return pick({"min", "max"}) + list(1 + random_() % 4);
      case 2:
        return "clamp" + list(3);
      default:
        return "hash" + list(1 + random_() % 8);
    }
  }
  std::string pick(std::initializer_list<const char*> choices) { return choices.begin()[random_() % choices.size()]; }

  std::mt19937_64 random_;
};

TEST(ExpressionProgram, AgreesWithTheWalkBitForBit) {
  Grower grow(11);
  constexpr std::array<double, 9> inputs = {0, 1, -1, 0.5, -2.25, 3, 1e-9, 7e5, -1e154};
  int values = 0;
  int faults = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = grow.expression(1 + i % 5);
    expr::Expression expression = parsed(text);
    std::array<std::uint32_t, 3> slots{};
    for (std::size_t k = 0; k < expression.names().size(); ++k) slots[k] = static_cast<std::uint32_t>(2 - k);
    expression = expression.bind(std::span(slots).first(expression.names().size()));
    ExpressionProgram program(expression);
    ASSERT_TRUE(program.is_compiled()) << text;
    for (int n = 0; n < 6; ++n) {
      const std::array<double, 3> in = {inputs[grow() % 9], inputs[grow() % 9], inputs[grow() % 9]};
      const expr::EvalResult walk = expr::evaluate(expression, in);
      const expr::EvalResult ours = program.evaluate(in);
      ASSERT_EQ(walk.failed_offset, ours.failed_offset) << text;
      ASSERT_EQ(walk.failed_length, ours.failed_length) << text;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(walk.value), std::bit_cast<std::uint64_t>(ours.value)) << text;
      ++(walk ? values : faults);
    }
  }
  EXPECT_GT(values, 10000);
  EXPECT_GT(faults, 2000);
}

TEST(ExpressionProgram, KeepsOurRules) {
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("floor(0.3/0.1)"), 3);
  EXPECT_EQ(value("mod(-7, 3)"), 2);
  EXPECT_EQ(value("7 and -2"), 1);
  EXPECT_EQ(value("round(-2.5)"), -3);
}

TEST(ExpressionProgram, ReportsTheFirstOperationWithoutValue) {
  ExpressionProgram program(parsed("1 + min(sqrt(x), 1/x)"));
  const auto fault = [&](double x) { return program.evaluate(std::array<double, 1>{x}); };
  EXPECT_EQ(fault(-1).failed_offset, 8);
  EXPECT_EQ(fault(-1).failed_length, 7);
  EXPECT_EQ(fault(0).failed_offset, 17);
  EXPECT_EQ(fault(0).failed_length, 3);
  EXPECT_EQ(fault(4).value, 1.25);  // and nothing of the earlier failures is left
}

TEST(ExpressionProgram, LeavesUntakenBranchesAlone) {
  EXPECT_TRUE(ExpressionProgram(parsed("1 ? 2 : 1/0")).evaluate({}));
  EXPECT_TRUE(ExpressionProgram(parsed("0 and 1/0")).evaluate({}));
  EXPECT_TRUE(ExpressionProgram(parsed("1 or 1/0")).evaluate({}));
  EXPECT_FALSE(ExpressionProgram(parsed("1 and 1/0")).evaluate({}));
}

TEST(ExpressionProgram, CopiesAreIndependent) {
  ExpressionProgram first(parsed("1/x"));
  ExpressionProgram second = first;
  EXPECT_FALSE(first.evaluate(std::array<double, 1>{0}));
  EXPECT_EQ(second.evaluate(std::array<double, 1>{4}).value, 0.25);
  first = second;
  EXPECT_EQ(first.evaluate(std::array<double, 1>{2}).value, 0.5);
}

TEST(ExpressionProgram, WalksWhatIsTooLongForMuParser) {
  std::string sum = "x";
  for (int i = 0; i < 20000; ++i) sum += "+x";
  ExpressionProgram program(parsed(sum));
  EXPECT_FALSE(program.is_compiled());
  EXPECT_EQ(program.evaluate(std::array<double, 1>{1}).value, 20001);
}

TEST(ExpressionProgram, IgnoresTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* comma : {"de_DE.UTF-8", "de_DE", "C.UTF-8"})
    if (std::setlocale(LC_ALL, comma) != nullptr) break;
  EXPECT_EQ(value("1.5 + 2.25"), 3.75);
  std::setlocale(LC_ALL, before.c_str());
}

}  // namespace
}  // namespace meso::eval
