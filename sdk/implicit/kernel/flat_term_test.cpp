// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/flat_term.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

namespace meso::implicit {
namespace {

const Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);

Term parsed(const char* text) {
  const expr::ParseResult r = expr::parse_expression(text, LengthUnit::millimeter);
  EXPECT_TRUE(r.expression) << text;
  std::vector<Term> names;
  for (const expr::Name& name : r.expression->names()) names.push_back(Term::coordinate(name.text[0] - 'x'));
  return Term::from_expression(*r.expression, names);
}

const char* const smooth_expressions[] = {
    "sin(x*y) + cos(z)/(2 + y^2)",
    "exp(-x^2) * tan(z/3)",
    "atan2(y, 3 + x) * hypot(x, z)",
    "log(5 + x*y*z)",
    "sqrt(x^2 + y^2 + z^2) - 1",
    "asin(x/4) - acos(y/4) + atan(z)",
    "max(x*y, min(z, sin(y)))",
    "clamp(x + y, -0.5, z)",
    "x > 0.3 ? x*y : z^3",
    "abs(x - y) * 2^z",
    "mod(x, 1.7) + sign(z) * y",
    "(3 + x)^y",
    "floor(x) + x*z",
    "hypot(hypot(x, y) - 1, z)",
};

TEST(FlatTerm, GradientAgreesWithDifferences) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> u(-1.5, 1.5);
  for (const char* text : smooth_expressions) {
    const FlatTerm f(parsed(text));
    int agree = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3 p{u(engine), u(engine), u(engine)};
      const Vec3 g = f.gradient(p);
      bool near = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double h = 1e-6;
        Vec3 a = p, b = p;
        a[axis] -= h;
        b[axis] += h;
        near = near && std::abs((f.value(b) - f.value(a)) / (2 * h) - g[axis]) < 1e-7 * (1 + norm(g));
      }
      agree += near ? 1 : 0;
    }
    EXPECT_GE(agree, 198) << text;  // kinks and jumps are rarely met
  }
}

TEST(FlatTerm, IntervalsHoldSamplesAndShrinkWithTheBox) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> u(-1.5, 1.5), unit(0, 1);
  for (const char* text : smooth_expressions) {
    const FlatTerm f(parsed(text));
    for (int i = 0; i < 100; ++i) {
      Box3 box;
      const double size = i % 2 == 0 ? 0.3 : 1e-9;
      box.min = {u(engine), u(engine), u(engine)};
      box.max = box.min + Vec3{size, size * unit(engine), size};
      const Interval value = f.interval(box);
      const std::array<Interval, 3> gradient = f.gradient_interval(box);
      const double slope = f.lipschitz(box);
      Vec3 before = box.min;
      for (int k = 0; k < 20; ++k) {
        Vec3 p;
        for (std::size_t axis = 0; axis < 3; ++axis)
          p[axis] = box.min[axis] + (box.max[axis] - box.min[axis]) * unit(engine);
        EXPECT_TRUE(value.contains(f.value(p))) << text;
        const Vec3 g = f.gradient(p);
        for (std::size_t axis = 0; axis < 3; ++axis)
          EXPECT_TRUE(std::isnan(g[axis]) ||
                      (gradient[axis].lo <= g[axis] + 1e-12 && g[axis] - 1e-12 <= gradient[axis].hi))
              << text << " " << g[axis] << " not in " << gradient[axis].lo << " ... " << gradient[axis].hi;
        EXPECT_LE(std::abs(f.value(p) - f.value(before)), slope * norm(p - before) + 1e-12) << text;
        before = p;
      }
      if (size < 1e-6) {
        EXPECT_TRUE(value.hi - value.lo < 0.1 || value.undefined || std::isinf(slope)) << text;
      }
    }
  }
}

TEST(FlatTerm, DistanceHasSlopeOneAndJumpsHaveNone) {
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_NEAR(FlatTerm(sqrt(x * x + y * y + z * z)).lipschitz(box), std::sqrt(3.0), 1e-9);  // component by component
  EXPECT_NEAR(FlatTerm(parsed("hypot(x, y)")).lipschitz(box), std::sqrt(2.0), 1e-9);
  EXPECT_EQ(FlatTerm(parsed("x > 0 ? 1 : 0")).lipschitz(box), HUGE_VAL);
  EXPECT_EQ(FlatTerm(parsed("floor(x)")).lipschitz(box), HUGE_VAL);
  EXPECT_NEAR(FlatTerm(parsed("x > 2 ? y : 3*x")).lipschitz(box), 3, 1e-12);
  const Box3 everywhere{{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  EXPECT_NEAR(FlatTerm(parsed("sin(2*x) + cos(3*y)")).lipschitz(everywhere), std::sqrt(13.0), 1e-9);
  EXPECT_EQ(FlatTerm(parsed("x*y")).lipschitz(everywhere), HUGE_VAL);
}

TEST(FlatTerm, ManyPointsGiveTheValuesOfOneByOne) {
  const FlatTerm f(parsed("sin(x*y) + (z > 0 ? x : y)"));
  std::vector<Vec3> points;
  for (int i = 0; i < 5000; ++i) points.push_back({i * 0.01, 1 - i * 0.003, i % 7 - 3.0});
  std::vector<double> values(points.size());
  f.values(points, values);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(values[i], f.value(points[i]));
}

/// f(x, y, z) = 2 x + 1
class Doubled final : public ExternalField {
 public:
  double value(Vec3 p) const override { return 2 * p.x + 1; }
  Interval interval(const Box3& box) const override { return {2 * box.min.x + 1, 2 * box.max.x + 1}; }
  double lipschitz() const override { return 2; }
  Box3 bounds(double) const override { return {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}}; }
  std::unique_ptr<Prepared> prepare(const Grid&, const Affine&, double, const RunOptions&) const override {
    return nullptr;
  }
};

TEST(FlatTerm, ExternalLeavesMoveWithTheirMap) {
  const Affine quarter{rotation({0, 0, 1}, std::acos(-1.0) / 2), {0, 0, 0}};  // (x, y) -> (-y, x)
  const FlatTerm f(Term::external(std::make_shared<Doubled>()).at(quarter));
  EXPECT_NEAR(f.value({5, 3, 0}), -5, 1e-12);
  EXPECT_NEAR(f.gradient({5, 3, 0}).y, -2, 1e-6);
  const Interval range = f.interval({{0, 1, 0}, {1, 2, 1}});
  EXPECT_TRUE(range.contains(-3) && range.contains(-1));
  EXPECT_NEAR(range.hi - range.lo, 2, 1e-9);
}

TEST(FlatTerm, EqualStepsAreOneStep) {
  const FlatTerm f(parsed("sin(2*pi*x)*sin(2*pi*x) + sin(2*pi*x)"));
  EXPECT_EQ(f.steps().size(), 6U);  // 2 pi, x, their product, the sine, its square, the sum
  EXPECT_NEAR(f.interval({{-1, 0, 0}, {1, 1, 1}}).lo, -1, 1e-12);  // the square is not negative
}

TEST(FlatTerm, AnyDepthIsFine) {
  Term deep = x;
  for (int i = 0; i < 100000; ++i) deep = i % 2 == 0 ? min(deep, y) : deep + Term::constant(1);
  EXPECT_EQ(deep.value({0, 1, 0}), 2);  // min(..., 1) + 1 at the end
  const Term moved = deep.at(Affine::from_translation({0, 1, 0}));
  EXPECT_EQ(moved.value({0, 0, 0}), 2);
  const FlatTerm flat(moved);
  EXPECT_TRUE(flat.interval({{0, 0, 0}, {1, 1, 1}}).contains(2));
  EXPECT_EQ(flat.gradient({0, 0, 0}), (Vec3{0, 1, 0}));
}

}  // namespace
}  // namespace meso::implicit
