// SPDX-License-Identifier: Apache-2.0
// The ball of an octet truss: its twelve struts leave no half circle free for a seam from pole to pole along the axes.
#include "sphere_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace meso::step {
namespace {

using namespace brep;

Template ball_with_holes(const std::vector<Vec3>& directions, double angle) {
  Template ball;
  FaceTemplate face{.surface = SphereSurface{.frame = {}, .radius = 1}};
  for (const Vec3& d : directions) {
    const Vec3 beside = cross(d, std::fabs(d.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    const Circle rim{{std::cos(angle) * d, d, (1 / norm(beside)) * beside}, std::sin(angle)};
    const auto index = static_cast<std::uint32_t>(ball.edges.size());
    ball.vertices.push_back(rim.frame.origin + rim.radius * rim.frame.x);
    ball.edges.push_back({.curve = rim, .vertex = {index, index}});
    face.loops.push_back({Coedge{.edge = index, .reversed = true}});
  }
  ball.faces.push_back(face);
  return ball;
}

/// Whether the seam, a half circle from pole to pole, keeps clear of the hole, or begins in it.
bool is_clear(const AxisFrame& frame, Vec3 hole, double angle) {
  if (std::fabs(dot(hole, frame.z)) > std::cos(angle)) return true;
  double nearest = 4;
  for (int i = 0; i <= 1000; ++i) {
    const double t = M_PI * i / 1000;
    nearest = std::min(nearest, std::acos(dot(hole, std::cos(t) * frame.z + std::sin(t) * frame.x)));
  }
  return nearest > angle;
}

TEST(SphereFrame, KeepsPolesAndSeamClearOfHoles) {
  const double s = std::sqrt(0.5), angle = std::asin(1 / 2.1);
  const std::vector<Vec3> octet{{s, s, 0},  {s, -s, 0},  {-s, s, 0}, {-s, -s, 0}, {s, 0, s},  {s, 0, -s},
                                {-s, 0, s}, {-s, 0, -s}, {0, s, s},  {0, s, -s},  {0, -s, s}, {0, -s, -s}};
  const Template ball = ball_with_holes(octet, angle);
  const auto& sphere = std::get<SphereSurface>(ball.faces[0].surface);
  const AxisFrame frame = clear_frame(sphere, ball.faces[0], ball);
  EXPECT_NEAR(dot(frame.x, frame.z), 0, 1e-15);
  EXPECT_NEAR(norm(frame.x), 1, 1e-15);
  EXPECT_FALSE(is_clear(sphere.frame, octet[4], angle)) << "the test tests nothing";
  for (const Vec3& hole : octet) EXPECT_TRUE(is_clear(frame, hole, angle));
}

TEST(SphereFrame, StaysWhereItIsClear) {
  const double t = std::sqrt(1 / 3.0);
  const Template ball = ball_with_holes({{t, t, t}, {-t, t, t}, {t, -t, -t}, {-t, -t, -t}}, 0.4);
  const auto& sphere = std::get<SphereSurface>(ball.faces[0].surface);
  EXPECT_EQ(clear_frame(sphere, ball.faces[0], ball).x, sphere.frame.x);
}

TEST(SphereFrame, TheOnlyHoleIsAroundAPole) {
  const Vec3 hole{0.6, 0, -0.8};
  const Template ball = ball_with_holes({hole}, 0.4);
  const AxisFrame frame = clear_frame(std::get<SphereSurface>(ball.faces[0].surface), ball.faces[0], ball);
  EXPECT_GT(std::fabs(dot(frame.z, hole)), std::cos(0.4));
}

}  // namespace
}  // namespace meso::step
