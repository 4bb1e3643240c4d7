// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "meso/implicit/field_arguments.hpp"
#include "meso/implicit/surfaces.hpp"

namespace meso::implicit {
namespace {

constexpr double pi = std::numbers::pi;

void expect_box(const Box3& box, Vec3 min, Vec3 max, double tolerance = 0) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(box.min[i] == min[i] || std::abs(box.min[i] - min[i]) <= tolerance) << i << ": " << box.min[i];
    EXPECT_TRUE(box.max[i] == max[i] || std::abs(box.max[i] - max[i]) <= tolerance) << i << ": " << box.max[i];
  }
}

constexpr double inf = HUGE_VAL;

TEST(Field, PrimitivesAreDistances) {
  EXPECT_EQ(Field::ball(2).value({3, 0, 0}), 1);
  EXPECT_EQ(Field::box({1, 2, 3}).value({0, 0, 0}), -1);
  EXPECT_EQ(Field::box({1, 2, 3}).value({4, 6, 3}), 5);
  EXPECT_EQ(Field::cylinder(1).value({3, 4, 1e6}), 4);
  EXPECT_NEAR(Field::cone(1, 0, 1).value({1, 0, 1}), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(Field::cone(1, 0, 1).value({2, 0, -1}), std::sqrt(2.0));
  EXPECT_EQ(Field::cone(1, 0, 1).value({0, 0, 3}), 2);
  EXPECT_EQ(Field::cone(1, 1, 2).value({0, 0, 1}), -1);
  EXPECT_EQ(Field::torus(3, 1).value({0, 3, 0}), -1);
  EXPECT_EQ(Field::torus(3, 1).value({0, 0, 4}), 4);
  EXPECT_EQ(Field::capsule({0, 0, 0}, {0, 0, 2}, 0.5).value({0, 3, 1}), 2.5);
  EXPECT_EQ(Field::capsule({0, 0, 0}, {0, 0, 2}, 0.5).value({0, 3, 6}), 4.5);
  EXPECT_EQ(Field::half_space({0, 0, 2}, 1).value({5, 5, 3}), 2);
}

TEST(Field, MovesMoveTheBody) {
  const Field f = Field::box({1, 2, 3});
  EXPECT_EQ(f.translated({1, 1, 1}).value({1, 1, 1}), -1);
  EXPECT_EQ(f.scaled(2).value({6, 0, 0}), 4);
  EXPECT_EQ(f.scaled(-2).value({6, 0, 0}), 4);
  EXPECT_EQ(f.scaled(Vec3{1, 3, 5}).value({4, 0, 0}), 3);
  EXPECT_EQ(f.scaled(Vec3{2, 3, 5}).value({0, 0, 0}), -2);
  EXPECT_EQ(f.rotated({0, 0, 1}, pi / 2).value({4, 0, 0}), 2);
  EXPECT_EQ(Field::cylinder().oriented({1, 0, 0}).value({1e6, 3, 4}), 4);
  EXPECT_EQ(Field::cone().oriented({0, 0, -1}).value({0, 0, -2}), 1);
  EXPECT_EQ(Field::ball().translated({3, 1, 0}).mirrored({5, 0, 0}).value({-3, 1, 0}), -1);
}

TEST(Field, BoundsOfBothSides) {
  expect_box(Field::ball().bounds(), {-1, -1, -1}, {1, 1, 1});
  expect_box(Field::ball().complement().bounds(), {-inf, -inf, -inf}, {inf, inf, inf});
  expect_box(Field::box().complement().complement().bounds(), {-1, -1, -1}, {1, 1, 1});
  expect_box(Field::ball().complement().shell(0.2).bounds(), {-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1});
  expect_box(Field::cylinder().bounds(), {-1, -1, -inf}, {1, 1, inf});
  expect_box(Field::cylinder().rotated({1, 0, 0}, pi / 2).bounds(), {-1, -inf, -1}, {1, inf, 1});
  expect_box(Field::cylinder().oriented({1, 0, 0}).scaled(0.5).bounds(), {-inf, -0.5, -0.5}, {inf, 0.5, 0.5});
  // An offset after a scale reaches further along the axes that were stretched more.
  expect_box(Field::box().scaled(Vec3{1, 2, 3}).offset(0.5).bounds(), {-1.5, -3, -4.5}, {1.5, 3, 4.5});
  expect_box(Field::half_space({0, -1, 0}, -2).bounds(), {-inf, 2, -inf}, {inf, inf, inf});
  expect_box(Field::half_space({0, -1, 0}, -2).complement().bounds(), {-inf, -inf, -inf}, {inf, 2, inf});
  expect_box(difference_of(Field::box(), Field::half_space({1, 0, 0})).bounds(), {0, -1, -1}, {1, 1, 1});
  EXPECT_TRUE(Field::ball().offset(-2).bounds().empty());
}

TEST(Field, HourglassOfThePaperHasTheBoxOfItsBlock) {
  const Field pair = union_of(Field::cylinder().translated({0, -2, 0}), Field::cylinder().translated({0, 2, 0}));
  const Field hourglass = intersection_of(pair.scaled(0.5).oriented({1, 0, 0}).complement(), Field::box());
  expect_box(hourglass.bounds(), {-1, -1, -1}, {1, 1, 1});
  EXPECT_LT(hourglass.value({0, 0, 0}), 0);
  EXPECT_GT(hourglass.value({0, 0.9, 0}), 0);
}

TEST(Field, SurfacesByAnyOfTheirNames) {
  DiagnosticSink sink;
  for (const char* name : {"p", "tpms.p", "schwarz-p", "tpms.primitive"}) {
    const auto f = Field::surface(name, sink);
    ASSERT_TRUE(f) << name;
    EXPECT_NEAR(f->value({0.25, 0.25, 0.5}), -1, 1e-15);
  }
  EXPECT_FALSE(Field::surface("gyroyd", sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_EQ(message(sink.diagnostics()[0]), "there is no surface 'gyroyd'; did you mean 'gyroid'?");
}

TEST(Field, ExpressionsTellTheirFaults) {
  DiagnosticSink sink;
  const Parameter parameters[] = {{"radius", 2}};
  const auto f = Field::expression("sqrt(x^2 + y^2 + z^2) - radius", sink, parameters);
  ASSERT_TRUE(f);
  EXPECT_EQ(f->value({2, 0, 0}), 0);
  EXPECT_FALSE(Field::expression("x + radios", sink, parameters));
  EXPECT_FALSE(Field::expression("x + ", sink));
  ASSERT_EQ(sink.diagnostics().size(), 2U);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::expression_unknown_name);
  EXPECT_EQ(sink.diagnostics()[0].where.offset, 4U);
  EXPECT_EQ(sink.diagnostics()[0].args[1], "; did you mean 'radius'?");
  EXPECT_EQ(sink.diagnostics()[1].code, Code::expression_missing_operand);
}

TEST(Field, ArgumentsThatCannotBeAreTold) {
  EXPECT_FALSE(check_scale({1, -2, 3}));
  EXPECT_EQ(message(*check_scale({0, 0, 0})), "a factor of scale must be finite and not 0, it is 0");
  EXPECT_EQ(message(*check_scale({1, 0, 2})), "every factor of scale must be finite and not 0, it is 1,0,2");
  EXPECT_TRUE(check_scale({1e-320, 1, 1}));  // its inverse is infinite
  EXPECT_TRUE(check_rotation({0, 0, 0}, 1));
  EXPECT_TRUE(check_rotation({0, 0, 1}, NAN));
  EXPECT_TRUE(check_direction("the direction of orient", {0, 0, 0}));
  EXPECT_EQ(message(*check_shell(-1)), "the thickness of a shell must be finite and not negative, it is -1");
  EXPECT_FALSE(check_shell(0));
  EXPECT_TRUE(check_shell(NAN));
  EXPECT_TRUE(check_translation({0, inf, 0}));
  EXPECT_TRUE(check_eccentric_shell(2, 1));
  EXPECT_TRUE(check_cone(0, 0, 1));
  EXPECT_TRUE(check_torus(1, 2));
  EXPECT_TRUE(check_size("the radius of a ball", 0));
}

TEST(Field, ChainsOfAnyLengthAreFine) {
  Field f = Field::ball();
  for (int i = 0; i < 100000; ++i) {
    const double s = i % 2 == 0 ? 1 : -1;
    switch (i % 10) {
      case 0:
        f = f.translated({0.001, 0, 0});
        break;
      case 1:
        f = f.rotated({0, 0, 1}, s * 0.01);
        break;
      case 2:
        f = union_of(f, Field::ball().translated({0.5 * s, 0, 0}));
        break;
      case 3:
        f = f.offset(s * 0.001);
        break;
      default:
        f = f.complement().complement();
    }
  }
  EXPECT_LT(f.value({0, 0, 0}), -0.49);  // in the ball that came last
  EXPECT_FALSE(f.bounds().empty());
  EXPECT_TRUE(f.interval({{-1, -1, -1}, {1, 1, 1}}).contains(f.value({0.5, 0.5, 0.5})));
}

TEST(Field, SharedPartsStayShared) {
  Field f = Field::ball();
  for (int i = 0; i < 100; ++i) f = union_of(f.offset(0), f);  // 2^100 leaves if it were a tree
  EXPECT_EQ(f.value({0, 0, 0}), -1);
  expect_box(f.bounds(), {-1, -1, -1}, {1, 1, 1});
}

// A set does not depend on the order of what it is made of.
TEST(Expression, WithoutAValueIsOutsideWhateverItIsCombinedWith) {
  DiagnosticSink sink;
  const Field half = *Field::expression("-1 - sqrt(x)", sink);  // all points with x >= 0
  const Field ball = Field::ball();
  const Vec3 undefined{-0.5, 0, 0}, defined{0.5, 0, 0};
  EXPECT_LT(union_of(half, ball).value(undefined), 0);
  EXPECT_LT(union_of(ball, half).value(undefined), 0);
  EXPECT_GT(intersection_of(half, ball).value(undefined), 0);
  EXPECT_GT(intersection_of(ball, half).value(undefined), 0);
  EXPECT_LT(difference_of(ball, half).value(undefined), 0);
  EXPECT_GT(difference_of(ball, half).value(defined), 0);
  EXPECT_LT(intersection_of(ball, half).value(defined), 0);
}

}  // namespace
}  // namespace meso::implicit
