// SPDX-License-Identifier: Apache-2.0
#include "sphere_pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace meso::step {
namespace {

using namespace brep;

constexpr double turn = std::numbers::pi / 6;  ///< of a hole, from its middle to its circle

/// A ball of radius 1 without two caps in the plane y = 0, whose circles meet in (1, 0, 0) , one vertex if they are
/// `touching`.
Template ball_with_two_caps(bool touching) {
  Template ball;
  FaceTemplate face{.surface = SphereSurface{.frame = {}, .radius = 1}};
  ball.vertices = {
      {1, 0, 0}, {std::cos(2 * turn), 0, std::sin(2 * turn)}, {std::cos(2 * turn), 0, -std::sin(2 * turn)}};
  for (const double side : {1.0, -1.0}) {
    const Vec3 axis{std::cos(turn), 0, side * std::sin(turn)};
    const Vec3 x = (1 / std::sin(turn)) * (ball.vertices[0] - std::cos(turn) * axis);
    const Circle rim{{std::cos(turn) * axis, -axis, x}, std::sin(turn)};  // clockwise about the hole
    const std::uint32_t far = side > 0 ? 1 : 2;
    ball.edges.push_back({.curve = rim, .vertex = {0, far}});
    ball.edges.push_back({.curve = rim, .vertex = {far, 0}});
  }
  if (touching) {
    face.loops = {{{.edge = 0}, {.edge = 1}, {.edge = 2}, {.edge = 3}}};
  } else {
    ball.vertices.push_back({1, 0, 0});
    ball.edges[2].vertex[0] = ball.edges[3].vertex[1] = 3;
    face.loops = {{{.edge = 0}, {.edge = 1}}, {{.edge = 2}, {.edge = 3}}};
  }
  ball.faces = {face};
  return ball;
}

SpherePieces pieces_of(const Template& ball) {
  return divided(std::get<SphereSurface>(ball.faces[0].surface), ball.faces[0], ball);
}

TEST(SpherePieces, TouchingHolesAreDividedWhereTheyTouch) {
  const SpherePieces made = pieces_of(ball_with_two_caps(true));
  ASSERT_EQ(made.pieces.size(), 2u);
  std::map<std::uint32_t, int> sum, uses;
  for (const FaceTemplate& piece : made.pieces) {
    ASSERT_EQ(piece.loops.size(), 1u);
    std::set<VertexKey> passed;
    const auto& loop = piece.loops[0];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      EXPECT_TRUE(passed.insert(vertex_of(loop[i], 0, made.border)).second);
      EXPECT_EQ(vertex_of(loop[i], 1, made.border), vertex_of(loop[(i + 1) % loop.size()], 0, made.border));
      ++uses[loop[i].edge];
      sum[loop[i].edge] += loop[i].reversed ? -1 : 1;
    }
  }
  ASSERT_EQ(made.edges.size(), 4u);
  for (std::uint32_t e = 0; e < made.border.edges.size(); ++e) {
    EXPECT_EQ(uses[e], e < 4 ? 1 : 2) << e;  // the cut is between its two sides
    EXPECT_EQ(sum[e], e < 4 ? 1 : 0) << e;
  }
}

TEST(SpherePieces, TheCutKeepsClearOfTheHoles) {
  const SpherePieces made = pieces_of(ball_with_two_caps(true));
  ASSERT_GT(made.border.edges.size(), 4u);
  for (std::size_t e = 4; e < made.border.edges.size(); ++e) {
    const Vec3 a = made.border.vertices[made.border.edges[e].vertex[0]];
    const Vec3 b = made.border.vertices[made.border.edges[e].vertex[1]];
    for (int i = 1; i < 20; ++i) {
      const Vec3 way = (1 - i / 20.0) * a + (i / 20.0) * b;
      for (const double side : {1.0, -1.0})
        EXPECT_LT(dot(way, {std::cos(turn), 0, side * std::sin(turn)}) / norm(way), std::cos(turn));
    }
  }
}

TEST(SpherePieces, HolesThatDoNotTouchNeedNoCut) { EXPECT_TRUE(pieces_of(ball_with_two_caps(false)).pieces.empty()); }

}  // namespace
}  // namespace meso::step
