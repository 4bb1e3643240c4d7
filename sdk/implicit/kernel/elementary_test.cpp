// SPDX-License-Identifier: Apache-2.0
// The vector kernels' own elementary functions against the C library in long double, and every operation against the
// plain walk, on each instruction set that this machine has.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "fields_for_test.hpp"
#include "meso/expr/operations.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

using expr::Op;
const Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);

std::vector<InstructionSet> supported() {
  std::vector<InstructionSet> result;
  for (const auto set : {InstructionSet::sse2, InstructionSet::avx2, InstructionSet::avx512})
    if (is_supported(set)) result.push_back(set);
  return result;
}

std::vector<double> values_of(const Term& term, std::span<const Vec3> points, InstructionSet set) {
  std::vector<double> result(points.size());
  values(term, points, result.data(), set);
  return result;
}

std::vector<Vec3> arguments(std::initializer_list<double> reaches) {
  std::mt19937_64 random(7);
  std::vector<Vec3> points;
  for (const double reach : reaches)
    for (int n = 0; n < 20000; ++n) points.push_back({std::uniform_real_distribution(-reach, reach)(random), 0, 0});
  return points;
}

/// In units in the last place of the exact value, but none smaller than `floor`'s.
template <class Truth>
double worst_error(Op op, std::span<const Vec3> points, Truth truth, double floor = 0) {
  double worst = 0;
  const std::vector<double> found = values_of(Term::apply(op, {x}), points, InstructionSet::automatic);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const long double exact = truth(static_cast<long double>(points[p].x));
    const double size = std::max(std::abs(static_cast<double>(exact)), floor);
    const double unit = std::nextafter(size, HUGE_VAL) - size;
    worst = std::max(worst, static_cast<double>(std::abs(found[p] - exact)) / unit);
  }
  return worst;
}

TEST(Elementary, ErrorsAreSmall) {
  const auto angles = arguments({1e-8, 0.1, 1, 4, 100, 1e5, 4.9e6, 1e9, 1e300});
  // Next to a zero the argument's reduction leaves an absolute error of 2^-90.
  EXPECT_LT(worst_error(
                Op::sin, angles, [](long double v) { return std::sin(v); }, 1e-10),
            2.5);
  EXPECT_LT(worst_error(
                Op::cos, angles, [](long double v) { return std::cos(v); }, 1e-10),
            2.5);
  EXPECT_LT(worst_error(Op::exp, arguments({1e-8, 1, 20, 700}), [](long double v) { return std::exp(v); }), 1.5);
  EXPECT_LT(worst_error(
                Op::tan, angles, [](long double v) { return std::tan(v); }, 1e-10),
            4);
  const auto fractions = arguments({1e-8, 0.1, 0.5, 1}), any = arguments({0.1, 1, 3, 100, 1e10});
  EXPECT_LT(worst_error(Op::asin, fractions, [](long double v) { return std::asin(v); }), 3);
  EXPECT_LT(worst_error(Op::acos, fractions, [](long double v) { return std::acos(v); }), 3);
  EXPECT_LT(worst_error(Op::atan, any, [](long double v) { return std::atan(v); }), 1.5);
  auto positive = arguments({1, 2, 1e3, 1e300});
  for (Vec3& p : positive) p.x = std::abs(p.x);
  for (int k = -1073; k < 1024; ++k) positive.push_back({std::ldexp(1.0, k), 0, 0});
  for (int k = 1; k < 50; ++k)
    positive.push_back({1 + std::ldexp(1.0, -k), 0, 0}), positive.push_back({1 - std::ldexp(1.0, -k), 0, 0});
  EXPECT_LT(worst_error(Op::log, positive, [](long double v) { return std::log(v); }), 1.5);
}

TEST(Elementary, PowersAreExactToTheLastUnits) {
  std::mt19937_64 random(11);
  std::vector<Vec3> points;
  for (const double reach : {0.01, 1., 8., 60., 700.})
    for (int n = 0; n < 20000; ++n) {
      const double base = std::exp(std::uniform_real_distribution(-4., 4.)(random));
      const double exponent = std::uniform_real_distribution(-reach, reach)(random) / std::abs(std::log(base));
      points.push_back({base, exponent, 0});
    }
  const std::vector<double> found = values_of(Term::apply(Op::power, {x, y}), points, InstructionSet::automatic);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const long double exact = std::pow(static_cast<long double>(points[p].x), static_cast<long double>(points[p].y));
    ASSERT_LT(std::abs(found[p] - exact), 2 * 2.3e-16L * exact) << points[p].x << " ^ " << points[p].y;
  }
}

TEST(Elementary, SinesStayWithinOne) {
  std::vector<Vec3> points;
  for (int k = -1000; k < 1000; ++k)
    for (int step = -300; step <= 300; ++step) {
      const double top = (k + 0.5) * std::numbers::pi;
      points.push_back(
          {top + step * std::ldexp(1.0, -28), top + std::numbers::pi / 2 + step * std::ldexp(1.0, -27), 0});
    }
  for (const Term& wave : {Term::apply(Op::sin, {x}), Term::apply(Op::cos, {y}), Term::apply(Op::cos, {2 * y})})
    for (const double v : values_of(wave, points, InstructionSet::automatic)) ASSERT_LE(std::abs(v), 1);
}

TEST(Elementary, SpecialValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> points;
  const std::vector<double> special = {0.,        -0.,
                                       1.,        -1.,
                                       0.5,       -0.5,
                                       1.5,       2.5,
                                       -2.5,      0.49999999999999994,
                                       1e-310,    -1e-310,
                                       2.,        1e16,
                                       -1e16,     1e300,
                                       -1e300,    709.,
                                       710.,      -745.1,
                                       -746.,     4503599627370497.5,
                                       5e-324,    HUGE_VAL,
                                       -HUGE_VAL, nan,
                                       1 - 1e-10, 3 + 1e-10,
                                       3 - 1e-8,  1e154,
                                       1e-160};
  for (const double a : special)
    for (const double b : special)
      for (const double c : {0., -0., 1., nan, 7.}) points.push_back({a, b, c});
  const auto check = [&](const Term& term, double ulps) {
    const FlatTerm flat(term);
    for (const InstructionSet set : supported()) {
      const std::vector<double> found = values_of(term, points, set);
      for (std::size_t p = 0; p < points.size(); ++p) {
        const double truth = flat.value(points[p]);
        const bool close = std::abs(found[p] - truth) <= ulps * 2.3e-16 * std::abs(truth) + ulps * 5e-324;
        ASSERT_TRUE(found[p] == truth || close || (std::isnan(truth) && std::isnan(found[p])))
            << "operation " << int(term.node().op) << " of " << points[p].x << ' ' << points[p].y << ' ' << points[p].z
            << ": " << found[p] << " for " << truth;
      }
    }
  };
  for (int op = int(Op::negate); op <= int(Op::select); ++op) {
    const auto o = static_cast<Op>(op);
    switch (o) {
      case Op::negate:
      case Op::logical_not:
      case Op::floor:
      case Op::ceil:
      case Op::round:
      case Op::abs:
      case Op::sign:
      case Op::sqrt:
      case Op::hash:
        check(Term::apply(o, {x}), 0);
        break;
      case Op::exp:
      case Op::log:
      case Op::sin:
      case Op::cos:
      case Op::tan:
      case Op::asin:
      case Op::acos:
      case Op::atan:
        check(Term::apply(o, {x}), 3);
        break;
      case Op::power:
        check(Term::apply(o, {x, y}), 3);
        check(Term::apply(o, {x, Term::constant(2.5)}), 3);
        check(Term::apply(o, {Term::constant(3), x}), 3);
        check(Term::apply(o, {x, Term::constant(3)}), 3);
        break;
      case Op::atan2:
      case Op::hypot:
        check(Term::apply(o, {x, z}), 3);
        check(Term::apply(o, {z, x}), 3);
        check(Term::apply(o, {x, y}), 3);
        break;
      case Op::clamp:
      case Op::select:
        check(Term::apply(o, {x, y, z}), 0);
        check(Term::apply(o, {z, x, y}), 0);
        break;
      default:
        check(Term::apply(o, {x, y}), 0);
        check(Term::apply(o, {x, z}), 0);
        check(Term::apply(o, {z, x}), 0);
        check(Term::apply(o, {x, Term::constant(3)}), 0);
        check(Term::apply(o, {Term::constant(3), x}), 0);
    }
  }
  check(Term::apply(Op::hash, {x, y, z}), 0);
}

}  // namespace
}  // namespace meso::implicit
