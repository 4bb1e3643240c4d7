// SPDX-License-Identifier: Apache-2.0
// Cells that are put together face by face, against closed forms.
#include "lattice/jointed_cell.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "beam_graph_joints.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "shape_to_body.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
using Primitives = std::vector<CellPrimitive>;

double ball_volume(double r) { return 4 * pi / 3 * r * r * r; }
double cap_volume(double ball, double along) { return pi * (ball - along) * (ball - along) * (2 * ball + along) / 3; }

/// Between the balls about its ends, with the part of it that is in them left out; and the caps that it takes of them.
double strut_beyond_balls(double length, double r, double ball) {
  const StrutEnd end = leave_ball(ball, r, 0);
  return pi * r * r * (length - 2 * end.along) - 2 * cap_volume(ball, end.along);
}
double tapered_beyond_balls(double length, std::array<double, 2> r, std::array<double, 2> ball) {
  const double growth = (r[1] - r[0]) / length;
  const StrutEnd a = leave_ball(ball[0], r[0], growth), b = leave_ball(ball[1], r[1], -growth);
  return pi / 3 * (length - a.along - b.along) * (a.radius * a.radius + a.radius * b.radius + b.radius * b.radius) -
         cap_volume(ball[0], a.along) - cap_volume(ball[1], b.along);
}

void expect_cell(const Primitives& primitives, const Box3& box, double volume, std::size_t solids = 1) {
  for (const int variant : {0, 2}) {
    std::string why;
    const auto shape = jointed_cell(primitives, box, 1e-6 * norm(box.max - box.min), variant, why);
    ASSERT_TRUE(shape) << why;
    DiagnosticSink sink;
    const auto body = shape_to_body(*shape, {}, sink);
    ASSERT_TRUE(body);
    EXPECT_EQ(body->solids.size(), solids);
    EXPECT_TRUE(audit(*body).clean());
    EXPECT_NEAR(measure(*body).volume / volume, 1, 1e-8);
    EXPECT_TRUE(BRepCheck_Analyzer(*shape).IsValid());
  }
}
std::string why_not(const Primitives& primitives, const Box3& box) {
  std::string why;
  EXPECT_FALSE(jointed_cell(primitives, box, 1e-6, 0, why));
  return why;
}

const Box3 cube{{0, 0, 0}, {4, 4, 4}};

Vec3 corner(int i) { return {i & 1 ? 4.0 : 0, i & 2 ? 4.0 : 0, i & 4 ? 4.0 : 0}; }

/// Struts from the corners to the middle.
Primitives body_centred(double r, double ball) {
  Primitives out{Ball{{2, 2, 2}, ball}};
  for (int i = 0; i < 8; ++i) {
    out.push_back(Ball{corner(i), ball});
    out.push_back(Frustum{corner(i), {2, 2, 2}, r, r});
  }
  return out;
}
double body_centred_volume(double r, double ball) {
  return 2 * ball_volume(ball) + 8 * strut_beyond_balls(2 * std::sqrt(3.0), r, ball);
}

// The circles of all struts of a node touch each other, and the sides of the box.
TEST(JointedCell, StrutsThatTouchTheSides) {
  const double r = 0.4, ball = r * std::sqrt(3.0);
  expect_cell(body_centred(r, ball), cube, body_centred_volume(r, ball));
}

TEST(JointedCell, StrutsNearTheSidesAndFarFromThem) {
  for (const double ball : {0.694, 0.72, 0.95})
    expect_cell(body_centred(0.4, ball), cube, body_centred_volume(0.4, ball));
}

TEST(JointedCell, SidesThroughTheMiddleHalveIt) {
  const double r = 0.4, ball = r * std::sqrt(3.0), half = body_centred_volume(r, ball) / 2;
  expect_cell(body_centred(r, ball), {{0, 0, 0}, {4, 4, 2}}, half);
  expect_cell(body_centred(r, ball), {{0, 2, 0}, {4, 4, 4}}, half);
  expect_cell(body_centred(r, ball), {{2, 2, 2}, {4, 4, 4}}, half / 4);
}

TEST(JointedCell, ABallOfTheNextCellMayBeLarger) {
  Primitives cell = body_centred(0.4, 0.72);
  cell.push_back(Ball{corner(5), 1.1});
  const double length = 2 * std::sqrt(3.0);
  const double one = strut_beyond_balls(length, 0.4, 0.72),
               other = tapered_beyond_balls(length, {0.4, 0.4}, {1.1, 0.72});
  expect_cell(cell, cube, body_centred_volume(0.4, 0.72) + (ball_volume(1.1) - ball_volume(0.72)) / 8 + other - one);
}

TEST(JointedCell, StrutsThatTaper) {
  Primitives cell = body_centred(0.4, 0.72);
  std::get<Frustum>(cell[2]).start_radius = 0.3;
  const double length = 2 * std::sqrt(3.0);
  expect_cell(cell, cube,
              body_centred_volume(0.4, 0.72) + tapered_beyond_balls(length, {0.3, 0.4}, {0.72, 0.72}) -
                  strut_beyond_balls(length, 0.4, 0.72));
}

// Quarters of struts; three circles touch in pairs on the sides.
TEST(JointedCell, StrutsAlongTheEdges) {
  const double r = 0.5, ball = r * std::sqrt(2.0);
  for (const double radius : {ball, 0.8}) {
    Primitives cell;
    for (int i = 0; i < 8; ++i) cell.push_back(Ball{corner(i), radius});
    for (int i = 0; i < 8; ++i)
      for (int bit = 1; bit < 8; bit *= 2)
        if ((i & bit) == 0) cell.push_back(Frustum{corner(i), corner(i | bit), r, r});
    expect_cell(cell, cube, ball_volume(radius) + 3 * strut_beyond_balls(4, r, radius));
  }
}

// Halves of struts, from the corners to the middles of the sides.
TEST(JointedCell, StrutsInTheSides) {
  const double r = 0.25, ball = 2 * r;
  Primitives cell;
  for (int i = 0; i < 8; ++i) cell.push_back(Ball{corner(i), ball});
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double at : {0.0, 4.0}) {
      Vec3 middle{2, 2, 2};
      middle[axis] = at;
      cell.push_back(Ball{middle, ball});
      for (int i = 0; i < 8; ++i)
        if (corner(i)[axis] == at) cell.push_back(Frustum{middle, corner(i), r, r});
    }
  expect_cell(cell, cube, 4 * ball_volume(ball) + 12 * strut_beyond_balls(2 * std::sqrt(2.0), r, ball));
}

TEST(JointedCell, WhatIsNotOfThatFormIsToldWhy) {
  Primitives diagonal{Ball{{0, 0, 0}, 1}, Ball{{4, 4, 8}, 1}, Frustum{{0, 0, 0}, {4, 4, 8}, 0.5, 0.5}};
  EXPECT_EQ(why_not(diagonal, cube), "a side of the box divides a strut");
  diagonal.erase(diagonal.begin());
  EXPECT_EQ(why_not(diagonal, cube), "a strut ends in no ball");
  EXPECT_EQ(why_not({Ball{{2, 2, 1}, 1}, Ball{{2, 2, 3}, 0.7}, Frustum{{2, 2, 1}, {2, 2, 3}, 0.4, 0.4}}, cube),
            "a face goes around its ball");
  EXPECT_NE(why_not(body_centred(0.4, 0.6), cube).find("meet beyond its ball"), std::string::npos);
}

TEST(JointedCell, NothingIsLeftBeyondTheBox) {
  std::string why;
  const auto shape = jointed_cell(body_centred(0.4, 0.72), {{20, 0, 0}, {24, 4, 4}}, 1e-6, 0, why);
  ASSERT_TRUE(shape) << why;
  EXPECT_TRUE(shape->IsNull());
}

}  // namespace
}  // namespace meso::brep
