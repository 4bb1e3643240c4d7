// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/term.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "meso/implicit/surface_edges.hpp"

namespace meso::implicit {
namespace {

const Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);

TEST(Term, ReadsAnExpression) {
  const auto parsed = expr::parse_expression("a < 0 ? -a : clamp(y, 0, 2) ^ 2 + z / 4", LengthUnit::millimeter);
  ASSERT_TRUE(parsed.expression);
  const Term names[] = {x, y, z};
  const Term t = Term::from_expression(*parsed.expression, names);
  EXPECT_EQ(t.value({-3, 0, 0}), 3);
  EXPECT_EQ(t.value({3, 1.5, 2}), 2.25 + 0.5);
  EXPECT_EQ(t.value({3, 9, -4}), 3);
}

TEST(Term, MovesByAnAffineMap) {
  const Term ball = sqrt(x * x + y * y + z * z) - 1;
  const Term moved = ball.at(Affine::from_translation({-2, 0, 0}));
  EXPECT_EQ(moved.value({2, 0, 0}), -1);
  EXPECT_EQ(moved.value({2, 3, 0}), 2);
  const Affine twice{rotation({0, 0, 1}, 1.0), {1, 2, 3}};
  const Vec3 p{0.3, -0.2, 0.7};
  EXPECT_NEAR((x + 2 * y * z).at(twice).at(twice).value(p), (x + 2 * y * z).value(twice * (twice * p)), 1e-14);
}

TEST(Term, KeepsSharedNodesShared) {
  Term t = x;
  for (int i = 0; i < 200; ++i) t = t + t;  // 2^200 leaves if it were a tree
  EXPECT_EQ(t.value({1, 0, 0}), std::ldexp(1.0, 200));
  EXPECT_EQ(t.at(Affine::from_translation({1, 0, 0})).value({0, 0, 0}), std::ldexp(1.0, 200));
}

TEST(Term, FoldsConstants) {
  EXPECT_TRUE((Term::constant(2) * Term::constant(3)).is_constant());
  EXPECT_TRUE(std::isnan(sqrt(Term::constant(-1)).node().number));
}

TEST(SurfaceEdges, AreWhereTwoSidesMeetOnTheSurface) {
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  const auto parsed = expr::parse_expression("sin(a) * cos(y) + z", LengthUnit::millimeter);
  const Term names[] = {x, y, z};
  const Term smooth = Term::from_expression(*parsed.expression, names);
  EXPECT_FALSE(may_have_edges(smooth, box));
  EXPECT_FALSE(may_have_edges(abs(smooth) - 0.3, box));
  EXPECT_FALSE(may_have_edges(-(abs(smooth) - 0.3), box));
  EXPECT_TRUE(may_have_edges(abs(smooth), box));
  EXPECT_TRUE(may_have_edges(abs(abs(smooth) - 0.3) - 0.1, box));
  EXPECT_TRUE(may_have_edges(max(smooth, x), box));
  // Cut at the sides of the box itself, and where one side always wins.
  EXPECT_FALSE(may_have_edges(max(smooth, abs(x) - 1), box));
  EXPECT_TRUE(may_have_edges(max(smooth, abs(x) - 0.9), box));
  EXPECT_FALSE(may_have_edges(min(smooth, x + 9), box));
}

}  // namespace
}  // namespace meso::implicit
