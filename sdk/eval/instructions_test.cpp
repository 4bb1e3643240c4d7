// SPDX-License-Identifier: Apache-2.0
// set, when, orient, rotate, scale, translate; defaults of cell parameters.
#include <gmock/gmock.h>

#include <random>

#include "document_text.hpp"
#include "orientation.hpp"

namespace meso::eval {
namespace {

using testing::ElementsAre;

const std::string three = "<loop index='i' axis='x' count='3' start='1' spacing='1'/>";
const std::string box = "<csg><box dx='1' dy='1' dz='1'/></csg>";

Affine placed(const std::string& instructions) {
  return cells_of(pattern_text("<list><place at='10,0,0'/></list>" + instructions)).at(0).world_from_cell;
}

TEST(Defaults, SeeThePlaceTheAxesAndTheIndices) {
  const auto cells = cells_of(pattern_text(three,
                                           "<parameter id='a' value='global.x + 100*i'/>"
                                           "<parameter id='b' value='2*a + x'/>" +
                                               box));
  EXPECT_THAT(cells[2].parameters, ElementsAre(203, 409));
}

TEST(Set, DefaultsThatFollowAreEvaluatedAgain) {
  const auto cells = cells_of(pattern_text(three + "<set parameter='t' value='t + i'/>",
                                           "<parameter id='t' value='1'/><parameter id='r' value='2*t'/>"
                                           "<parameter id='other' value='7'/>" +
                                               box));
  EXPECT_THAT(cells[2].parameters, ElementsAre(3, 6, 7));
}

TEST(Set, WhatWasSetStaysSet) {
  const auto cells = cells_of(pattern_text(
      three + "<set parameter='r' value='5'/><set parameter='t' value='i'/><set parameter='s' value='r + t'/>",
      "<parameter id='t' value='1'/><parameter id='r' value='2*t'/><parameter id='s' value='0'/>" + box));
  EXPECT_THAT(cells[1].parameters, ElementsAre(1, 5, 6));
}

TEST(Set, KeepsToTheBoundsOfTheParameter) {
  EXPECT_THAT(
      faults_of(pattern_text(three + "<set parameter='t' value='i'/>", "<parameter id='t' value='0' max='1'/>" + box)),
      ElementsAre("PARAMETER_RANGE in cell (2) of pattern 'p'"));
}

TEST(When, DroppedCellsKeepTheirIndex) {
  const auto cells = cells_of(pattern_text(three + "<when test='i != 1'/>"));
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(cells[1].ordinal, 2U);
  EXPECT_THAT(cells[1].index, ElementsAre(2));
}

TEST(When, ShieldsWhatFollows) {
  const auto cells = cells_of(
      pattern_text("<loop index='i' axis='x' count='2' spacing='1'/><loop index='j' axis='y' count='2' spacing='1'/>"
                   "<when test='j == 1 and i > 0'/><translate z='1/i'/>"));
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].world_from_cell.translation, (Vec3{1, 1, 1}));
}

TEST(Moves, EachActsInTheFrameThatEarlierOnesLeft) {
  const Affine w = placed("<rotate x='0' y='0' z='2' angle='90deg'/><scale factor='2'/><translate x='3'/>");
  expect_near(w.translation, {10, 6, 0});
  expect_near(w * Vec3{1, 0, 0}, {10, 8, 0});
}

TEST(Moves, NeedFactorsAboveZeroAndAnAxis) {
  EXPECT_THAT(faults_of(pattern_text(three + "<scale x='2 - i'/>")),
              ElementsAre("VALUE_NOT_POSITIVE in cell (2) of pattern 'p'"));
  EXPECT_THAT(faults_of(pattern_text(three + "<rotate x='i - 1' y='0' z='0' angle='1'/>")),
              ElementsAre("DIRECTION_ZERO in cell (1) of pattern 'p'"));
}

TEST(Orient, PointsTheAxisAlongTheVector) {
  expect_near(placed("<orient axis='z' x='1' y='2' z='2'/>").linear * Vec3{0, 0, 1}, {1. / 3, 2. / 3, 2. / 3});
  // The smallest turn from z to x is about y: y stays.
  expect_near(placed("<orient axis='z' x='5'  y='0' z='0'/>").linear * Vec3{0, 1, 0}, {0, 1, 0});
}

TEST(Orient, OppositeIsHalfATurnAboutTheNextAxis) {
  const Mat3 m = placed("<orient axis='z' x='0' y='0' z='-3'/>").linear;
  expect_near(m * Vec3{0, 0, 1}, {0, 0, -1});
  expect_near(m * Vec3{1, 0, 0}, {1, 0, 0});
}

TEST(Orient, FrameSaysWhoseComponents) {
  const std::string turn = "<rotate x='0' y='0' z='1' angle='90deg'/>";
  expect_near(placed(turn + "<orient axis='z' x='1' y='0' z='0'/>").linear * Vec3{0, 0, 1}, {0, 1, 0});
  expect_near(placed(turn + "<orient axis='z' x='1' y='0' z='0' frame='global'/>").linear * Vec3{0, 0, 1}, {1, 0, 0});
}

TEST(Orient, ZeroVectorsFollowTheRule) {
  const auto orient = [](const std::string& rule) {
    return pattern_text(three + "<orient axis='z' x='i - 1' y='0' z='0' " + rule + "/>");
  };
  EXPECT_THAT(faults_of(orient("")), ElementsAre("DIRECTION_ZERO in cell (1) of pattern 'p'"));
  EXPECT_EQ(cells_of(orient("zero='keep'")).at(1).world_from_cell.linear, Mat3{});
  const auto left = cells_of(orient("zero='drop'"));
  ASSERT_EQ(left.size(), 2U);
  EXPECT_THAT(left[1].index, ElementsAre(2));
}

TEST(Orient, ADroppingOrientationDropsAllInnerCells) {
  const auto cells =
      cells_of(pattern_text("<loop index='i' axis='x' count='2' spacing='1'/>"
                            "<loop index='j' axis='y' count='3' spacing='1'/>"
                            "<orient axis='z' x='i' y='0' z='0' zero='drop'/>"));
  EXPECT_EQ(cells.size(), 3U);
}

TEST(Orient, SignlessVectorsPointUpwards) {
  const std::string vector = "x='1' y='-2' z='-2'";
  expect_near(placed("<orient axis='x' " + vector + " signless='true'/>").linear * Vec3{1, 0, 0},
              {-1. / 3, 2. / 3, 2. / 3});
  EXPECT_EQ(without_sign({-1, 2, 0}), (Vec3{-1, 2, 0}));
  EXPECT_EQ(without_sign({-1, -2, 0}), (Vec3{1, 2, 0}));
}

TEST(Orient, SecondDirectionIsAsNearAsTheFirstAllows) {
  const Mat3 m = placed("<orient axis='z' x='0' y='1' z='0'><second axis='x' x='1' y='1' z='1'/></orient>").linear;
  const double h = std::sqrt(0.5);
  expect_near(m * Vec3{0, 0, 1}, {0, 1, 0});
  expect_near(m * Vec3{1, 0, 0}, {h, 0, h});
  EXPECT_NEAR(determinant(m), 1, 1e-12);
}

TEST(Orient, AllAxesGiveRotations) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 200; ++n) {
    const Vec3 a{normal(random), normal(random), normal(random)}, b{normal(random), normal(random), normal(random)};
    for (int first = 0; first < 3; ++first) {
      for (int second = 0; second < 3; ++second) {
        if (first == second) continue;
        const Mat3 m = two_axis_turn(static_cast<CellAxis>(first), a, static_cast<CellAxis>(second), b);
        EXPECT_NEAR(determinant(m), 1, 1e-12);
        expect_near(m.column(static_cast<std::size_t>(first)), a / norm(a));
        EXPECT_NEAR(dot(cross(a, b), m.column(static_cast<std::size_t>(second))), 0, 1e-12 * norm(a) * norm(b));
        EXPECT_GT(dot(b, m.column(static_cast<std::size_t>(second))), 0);
      }
      const Mat3 s = smallest_turn(static_cast<CellAxis>(first), a);
      const Mat3 gram = transposed(s) * s;
      for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(gram.m[i], Mat3{}.m[i], 1e-12);
      // The trace of a rotation is 1 + 2 cos(angle): no rotation to `a` turns by less than the angle between them.
      EXPECT_NEAR(s.m[0] + s.m[4] + s.m[8], 1 + 2 * a[static_cast<std::size_t>(first)] / norm(a), 1e-12);
    }
  }
}

}  // namespace
}  // namespace meso::eval
