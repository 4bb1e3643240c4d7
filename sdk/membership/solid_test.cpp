// SPDX-License-Identifier: Apache-2.0
// Shapes against closed forms: their volumes by counting, and single points.
#include "solid.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "meso/membership/volume_estimate.hpp"
#include "primitives.hpp"

namespace meso::membership {
namespace {

using namespace eval;
using std::numbers::pi;

/// By a grid of points over a cube of edge 10 about the origin: none of the bodies leaves it.
void expect_volume(const Shape& shape, double volume) {
  const Solid solid = make_solid(shape, {});
  const JitteredPoints points({{-5, -5, -5}, {5, 5, 5}}, 200'000, 7);
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < points.size(); ++i) answers.push_back(solid.at(points[i]));
  const VolumeEstimate found = estimate_volume(points, answers);
  EXPECT_EQ(found.low, found.high);
  EXPECT_NEAR(found.low, volume, 3 * found.deviation);
  EXPECT_LT(found.deviation, 0.02 * volume);
}

TEST(Solids, HaveTheVolumesOfTheirFormulas) {
  expect_volume({BoxShape{{-1, -2, -3}, {2, 3, 4}}}, 24);
  expect_volume({SphereShape{{1, 0.5, 0}, 3}}, 36 * pi);
  expect_volume({EllipsoidShape{{0, 1, 0}, {1, 2, 3}}}, 8 * pi);
  expect_volume({CylinderShape{{-2, -1, -2}, {2, 1, 2}, 1}}, pi * std::sqrt(36.0));
  expect_volume({ConeShape{{0, 0, -3}, {0, 0, 3}, 2, 1}}, pi * 6 / 3 * (4 + 2 + 1));
  expect_volume({TorusShape{{0, 0, 0}, Vec3{1, 2, 2} / 3, 3, 1}}, 2 * pi * pi * 3);
  expect_volume({ExtrusionShape{-1, 3, {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}}}, 3 * 7);
  expect_volume({RevolutionShape{{{1, -1}, {4, -1}, {4, 1}, {2, 1}, {2, 3}, {1, 3}}}}, 2 * pi * (15 + 3));
  expect_volume({RevolutionShape{{{0, -3}, {2, 0}, {0, 3}}}}, pi * 4 * 6 / 3);
}

TEST(Solids, Polyhedra) {
  // The box from -3 to 3 without the tetrahedron whose corners are the origin and 2 along each axis.
  Polyhedron p{.vertices = {{-3, -3, -3},
                            {3, -3, -3},
                            {3, 3, -3},
                            {-3, 3, -3},
                            {-3, -3, 3},
                            {3, -3, 3},
                            {3, 3, 3},
                            {-3, 3, 3},
                            {0, 0, 0},
                            {2, 0, 0},
                            {0, 2, 0},
                            {0, 0, 2}},
               .faces = {{0, 3, 2, 1},
                         {4, 5, 6, 7},
                         {0, 1, 5, 4},
                         {1, 2, 6, 5},
                         {2, 3, 7, 6},
                         {3, 0, 4, 7},
                         {8, 9, 10},
                         {8, 10, 11},
                         {8, 11, 9},
                         {9, 11, 10}}};
  expect_volume({PolyhedronShape{p}}, 216 - 8.0 / 6);
  EXPECT_FALSE(contains(PolyhedronShape{p}, {0.5, 0.5, 0.5}));
  EXPECT_TRUE(contains(PolyhedronShape{p}, {0.9, 0.9, 0.9}));
}

TEST(Solids, Booleans) {
  const Shape a{SphereShape{{0, 0, 0}, 2}}, b{SphereShape{{2, 0, 0}, 2}};
  const double ball = 32 * pi / 3, lens = pi * (4 * 2 + 2) * (4 - 2) * (4 - 2) / 12;  // pi (4r + d) (2r - d)^2 / 12
  expect_volume({BooleanShape{BooleanOperation::union_, {a, b}}}, 2 * ball - lens);
  expect_volume({BooleanShape{BooleanOperation::intersection, {a, b}}}, lens);
  expect_volume({BooleanShape{BooleanOperation::difference, {a, b}}}, ball - lens);
}

TEST(Solids, TransformsActOnTheUnion) {
  const Affine map{Mat3{{0.5, 0.2, 0, 0, 1.5, 0.3, 0, 0, -1}}, {1, 0, -1}};  // mirrored, too
  expect_volume({TransformedShape{map, {{SphereShape{{0, 0, 0}, 1}}, {SphereShape{{0, 0, 2.5}, 1}}}}},
                2 * 4 * pi / 3 * 0.75);
}

TEST(Solids, BeamsWithCaps) {
  const auto strut = [](BeamCap from, BeamCap to, double ball = 0) {
    return Shape{BeamsShape{{{{-2, 0, 0}, ball}, {{2, 0, 0}, 0}}, {{0, 1, 1, 1, from, to}}}};
  };
  expect_volume(strut(BeamCap::butt, BeamCap::butt), 4 * pi);
  expect_volume(strut(BeamCap::sphere, BeamCap::hemisphere), 4 * pi + 4 * pi / 3);
  // Of the ball of radius 2 the strut covers what lies within 1 of its axis, on one side: (V - bore) / 2 sticks out.
  const double bored = 4 * pi / 3 * std::pow(3, 1.5), ball = 32 * pi / 3, in_strut = (ball - bored) / 2;
  expect_volume(strut(BeamCap::butt, BeamCap::butt, 2), 4 * pi + ball - in_strut);
  // Beams that widen: half a ball stays behind the end's disc, a whole one does not matter.
  const Shape cone{BeamsShape{{{{-2, 0, 0}, 0}, {{2, 0, 0}, 0}}, {{0, 1, 0.5, 2, BeamCap::hemisphere, BeamCap::butt}}}};
  expect_volume(cone, pi * 4 / 3 * (0.25 + 1 + 4) + 2 * pi / 3 * 0.125);
}

std::shared_ptr<const CoordinateFrame> frame(std::vector<CoordinateAxis> axes) {
  return std::make_shared<const CoordinateFrame>(Affine{rotation(Vec3{2, 1, 2} / 3, 0.4), {0.3, -0.2, 0.1}},
                                                 std::move(axes));
}

TEST(VolumeElements, Straight) {
  const auto oblique = frame(
      {{"a", AxisKind::linear, {1, 0, 0}}, {"b", AxisKind::linear, {0.6, 0.8, 0}}, {"c", AxisKind::linear, {0, 0, 1}}});
  expect_volume({VolumeElementShape{oblique, {0, 1, 2}, {-1, 0, 1}, {2, 2, 3}}}, 3 * 2 * 2 * 0.8);
}

TEST(VolumeElements, Polar) {
  const auto polar = frame({{"r", AxisKind::distance, {1, 0, 0}},
                            {"t", AxisKind::circular, {0, 0, 1}},
                            {"h", AxisKind::linear, {0, 0, -1}}});
  expect_volume({VolumeElementShape{polar, {0, 1, 2}, {1, -0.5, -1}, {4, 2, 2}}}, (16 - 1) / 2.0 * 2.5 * 3);
  expect_volume({VolumeElementShape{polar, {2, 0, 1}, {-1, 0, 0}, {2, 3, 2 * pi}}}, 9 * pi * 3);
  // Angles count from where they are written, whole turns later too.
  expect_volume({VolumeElementShape{polar, {0, 1, 2}, {1, 6.5 * pi, 0}, {4, 7 * pi, 1}}}, 7.5 * pi / 2);
}

TEST(VolumeElements, ConesAndTwoDistances) {
  // The distance axis rises at 45 degrees: shells of cones.
  const double h = std::numbers::sqrt2 / 2;
  const auto conical = frame(
      {{"r", AxisKind::distance, {h, 0, h}}, {"t", AxisKind::circular, {0, 0, 1}}, {"h", AxisKind::linear, {0, 0, 1}}});
  expect_volume({VolumeElementShape{conical, {0, 1, 2}, {1, 0, -1}, {3, 2, 1}}}, (9 - 1) / 4.0 * 2 * 2);
  const auto two = frame({{"r", AxisKind::distance, {1, 0, 0}},
                          {"s", AxisKind::distance, {0, 0, 1}},
                          {"t", AxisKind::circular, {0, 0, 1}}});
  expect_volume({VolumeElementShape{two, {0, 1, 2}, {1, 1, 0}, {3, 3, 3}}}, 8 / 2.0 * 2 * 3);
}

TEST(VolumeElements, Spherical) {
  const auto spherical = frame({{"t", AxisKind::circular, {0, 0, 1}},
                                {"f", AxisKind::circular, {0, -1, 0}},
                                {"r", AxisKind::distance, {1, 0, 0}}});
  const double a = -0.3, b = 1.1;
  expect_volume({VolumeElementShape{spherical, {0, 1, 2}, {0.5, a, 1.5}, {2, b, 4}}},
                (64 - 3.375) / 3 * 1.5 * (std::sin(b) - std::sin(a)));
}

TEST(VolumeElements, WithoutAClosedFormAreNotKnown) {
  const auto swept = frame(
      {{"r", AxisKind::distance, {1, 0, 0}}, {"t", AxisKind::circular, {0, 0, 1}}, {"h", AxisKind::linear, {0, 1, 0}}});
  EXPECT_EQ(answer_at(VolumeElementShape{swept, {0, 1, 2}, {1, 0, 0}, {2, 1, 1}}, {1.5, 0.5, 0}), Answer::unknown);
}

TEST(Solids, WhatIsNotKnownStaysUnknownOnlyWhereItMatters) {
  const Shape implicit{ImplicitShape{}}, ball{SphereShape{{0, 0, 0}, 1}};
  const auto at = [&](BooleanOperation operation, Vec3 p) {
    return make_solid({BooleanShape{operation, {ball, implicit}}}, {}).at(p);
  };
  EXPECT_EQ(at(BooleanOperation::union_, {0, 0, 0}), Answer::inside);
  EXPECT_EQ(at(BooleanOperation::union_, {2, 0, 0}), Answer::unknown);
  EXPECT_EQ(at(BooleanOperation::intersection, {0, 0, 0}), Answer::unknown);
  EXPECT_EQ(at(BooleanOperation::intersection, {2, 0, 0}), Answer::outside);
  EXPECT_EQ(at(BooleanOperation::difference, {0, 0, 0}), Answer::unknown);
}

TEST(Solids, ImportsAreAskedInTheirOwnCoordinates) {
  const Shape import{ImportShape{.scale = 3, .transform = {rotation({0, 0, 1}, std::numbers::pi / 2), {1, 0, 0}}}};
  const Surroundings surroundings{.imports =
                                      [](const ImportShape&) {
                                        return ImportedSolid{{{0, 0, 0}, {1, 1, 1}}, [](Vec3 p) { return p.x < 0.5; }};
                                      },
                                  .part = {}};
  const Solid solid = make_solid(import, surroundings);
  // The file's (0.4, 0.9, 0.1) goes to (1.2, 2.7, 0.3), is turned to (-2.7, 1.2, 0.3) and moved to (-1.7, 1.2, 0.3).
  EXPECT_EQ(solid.at({-1.7, 1.2, 0.3}), Answer::inside);
  EXPECT_EQ(solid.at({-1.7, 1.8, 0.3}), Answer::outside);
  EXPECT_EQ(make_solid(import, {}).at({50, 50, 50}), Answer::unknown);
}

}  // namespace
}  // namespace meso::membership
