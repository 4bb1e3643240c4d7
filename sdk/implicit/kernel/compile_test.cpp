// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/compile.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "fields_for_test.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

const std::string gyroid = "cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)";

/// One of every kind of plan: per axis, per plane, tables, steps, choices, nothing that depends on x.
const std::vector<std::string> fields = {
    gyroid,
    "abs(" + gyroid + ") - 0.35",
    "max(" + gyroid + ", sqrt(x^2 + y^2 + z^2) - 0.9)",
    gyroid + " - sqrt(x^2 + y^2 + z^2)/2",
    "sin(2*pi*sqrt(x^2 + y^2)) + 0.2*z",
    "sin(2*pi*sqrt(x^2 + y^2))*cos(2*pi*z) + sin(2*pi*sqrt(x^2 + y^2 + z^2))",
    "sin(5*x*z) + cos(3*x*y*z)",
    "cos(2*pi*(3*x + y))*cos(2*pi*z) - sin(2*pi*(3*x - y))*sin(2*pi*z)",
    "min(min(hypot(x - 0.3, y) - 0.2, hypot(y + 0.3, z) - 0.2), max(abs(x), max(abs(y), abs(z))) - 0.5)",
    "x > 0 ? " + gyroid + " : (y > z ? x + y*z : log(0 - x) - exp(z*x))",
    "mod(x*3, 1) - 0.5 + floor(y*2)*z",
    "y^2 + z^2 - 0.5",
    "z - 0.1",
    "x",
    "0*x - 1",
    "(x + y + z)^3 - x^2*y + x/(2 + y)/z",
    "atan2(y, x) + 0.3*asin(z) - tan(x*y) + acos(x*z) - atan(x + y*z)",
};

bool is_near(float value, double truth) {
  if (std::isnan(truth)) return std::isnan(value);
  return value == static_cast<float>(truth) || std::abs(value - truth) <= 1e-7 * std::abs(truth) + 1e-12;
}

TEST(Compile, SamplesAreTheTermsValues) {
  const Grid grid{.box = {{-1, -0.5, 0}, {1, 0.7, 0.3}}, .nodes = {77, 21, 9}};
  for (const std::string& text : fields)
    for (const bool strict : {false, true}) {
      const Term term = term_of(text);
      const FlatTerm flat(term);
      const auto source = compile(term, grid, {.strict_math = strict, .pruning = Pruning::off});
      const Samples samples(*source, 8);
      for (std::int32_t k = 0; k < 9; ++k)
        for (std::int32_t j = 0; j < 21; ++j)
          for (std::int32_t i = 0; i < 77; ++i) {
            const double truth = flat.value(grid.node(i, j, k));
            const float value = samples.value(i, j, k);
            ASSERT_TRUE(is_near(value, truth)) << text << ": " << value << " for " << truth;
            ASSERT_TRUE(samples.is_inside(i, j, k) == (truth < 0) || std::abs(truth) < 1e-12) << text;
          }
    }
}

TEST(Compile, BitsPastTheRowAreZero) {
  for (const std::int32_t n : {2, 63, 64, 65, 127, 128}) {
    const auto source = compile(term_of("0*x - 1"), {.box = {{0, 0, 0}, {1, 1, 1}}, .nodes = {n, 2, 2}});
    std::uint64_t count = 0;
    for (const std::uint64_t word : Samples(*source, 2).inside)
      count += static_cast<std::uint64_t>(std::popcount(word));
    EXPECT_EQ(count, 4U * static_cast<unsigned>(n));
  }
}

TEST(Compile, InstructionSetsAgreeToTheBit) {
  const Grid grid{.box = {{-1, -1, -1}, {1, 1.1, 1}}, .nodes = {101, 23, 19}};
  for (const std::string& text : fields) {
    const Samples narrow(*compile(term_of(text), grid, {.instruction_set = InstructionSet::sse2}), 8);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      const Samples wide(*compile(term_of(text), grid, {.instruction_set = set}), 8);
      EXPECT_EQ(wide.inside, narrow.inside) << text;
      EXPECT_EQ(wide.bytes(), narrow.bytes()) << text;
    }
  }
}

/// A pruned row has the signs of a full one, and its values at both ends of every edge whose ends differ.
TEST(Compile, PruningChangesNothingThatCounts) {
  const Grid grid{.box = {{-1, -1, -1}, {1, 1.1, 1}}, .nodes = {150, 70, 41}};
  std::size_t left_out = 0;
  for (const std::string& text : fields)
    for (const bool strict : {false, true}) {
      const Samples all(*compile(term_of(text), grid, {.strict_math = strict, .pruning = Pruning::off}), 41);
      for (const std::int32_t slab : {8, 3}) {
        const Samples some(*compile(term_of(text), grid, {.strict_math = strict, .pruning = Pruning::on}), slab);
        ASSERT_EQ(some.inside, all.inside) << text;
        for (std::int32_t k = 0; k < 41; ++k)
          for (std::int32_t j = 0; j < 70; ++j)
            for (std::int32_t i = 0; i < 150; ++i) {
              const bool in = all.is_inside(i, j, k);
              const bool crosses =
                  (i > 0 && all.is_inside(i - 1, j, k) != in) || (i < 149 && all.is_inside(i + 1, j, k) != in) ||
                  (j > 0 && all.is_inside(i, j - 1, k) != in) || (j < 69 && all.is_inside(i, j + 1, k) != in) ||
                  (k > 0 && all.is_inside(i, j, k - 1) != in) || (k < 40 && all.is_inside(i, j, k + 1) != in);
              left_out += some.value(i, j, k) == Samples::untouched;
              if (crosses && !std::isnan(all.value(i, j, k))) {
                ASSERT_EQ(some.value(i, j, k), all.value(i, j, k)) << text << " at " << i << ' ' << j << ' ' << k;
              }
            }
      }
    }
  EXPECT_GT(left_out, fields.size() * 150 * 70 * 41);  // of four times as many: pruning does prune
}

TEST(Compile, FieldsBeyondFloatsCrossEdgesWhereTheyShould) {
  const Grid grid{.box = {{-1.3, -1.2, -1.1}, {1.2, 1.4, 1.25}}, .nodes = {70, 31, 20}};
  const std::string ball = "(x^2 + y^2 + z^2 - 1)";
  const Samples plain(*compile(term_of(ball), grid, {.pruning = Pruning::off}), 8);
  for (const std::string factor : {"1e-60", "1e-45", "-1e60", "1e300", "1e-290", "(1e-50*(2 + sin(x)))"}) {
    for (const Pruning pruning : {Pruning::off, Pruning::on}) {
      const auto source = compile(term_of(factor + "*" + ball), grid, {.pruning = pruning});
      const Samples samples(*source, 8);
      for (std::int32_t k = 0; k < 20; ++k)
        for (std::int32_t j = 0; j < 31; ++j)
          for (std::int32_t i = 1; i < 70; ++i) {
            const float a = plain.value(i - 1, j, k), b = plain.value(i, j, k);
            if (factor[0] != '-') {
              ASSERT_EQ(samples.is_inside(i, j, k), plain.is_inside(i, j, k)) << factor;
            }
            if (std::min(a, b) >= 0 || std::max(a, b) < 0 || factor[0] == '(') continue;
            const float c = samples.value(i - 1, j, k), d = samples.value(i, j, k);
            ASSERT_NEAR(c / (c - d), a / (a - b), 1e-6) << factor;
          }
      double at_zero = 1;
      source->sampler()->values_at(std::vector<Vec3>{{0, 0, 0}}, &at_zero);
      EXPECT_TRUE(std::abs(at_zero) > 1e-6 && std::abs(at_zero) < 1e6) << factor;
    }
  }
  // A pole does not make the rest small.
  double beside = 0;
  compile(term_of("x - 0.1 + exp(400*(y - 1))"), grid)->sampler()->values_at(std::vector<Vec3>{{0.6, 0, 0}}, &beside);
  EXPECT_EQ(beside, 0.5);
}

TEST(Compile, ValuesAtNodesHaveTheRowsSigns) {
  const Grid grid{.box = {{-1, -1, -1}, {1, 1.1, 1}}, .nodes = {50, 20, 11}};
  for (const std::string& text : fields) {
    const auto source = compile(term_of(text), grid);
    const Samples samples(*compile(term_of(text), grid, {.pruning = Pruning::off}), 8);
    std::vector<Vec3> points;
    for (std::int32_t k = 0; k < 11; ++k)
      for (std::int32_t j = 0; j < 20; ++j)
        for (std::int32_t i = 0; i < 50; ++i) points.push_back(grid.node(i, j, k));
    std::vector<double> values(points.size());
    source->sampler()->values_at(points, values.data());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const auto i = std::int32_t(p % 50), j = std::int32_t(p / 50 % 20), k = std::int32_t(p / 1000);
      ASSERT_EQ(values[p] < 0, samples.is_inside(i, j, k)) << text;
      ASSERT_TRUE(float(values[p]) == samples.value(i, j, k) || std::isnan(values[p])) << text;
    }
  }
}

}  // namespace
}  // namespace meso::implicit
