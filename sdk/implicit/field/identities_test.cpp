// SPDX-License-Identifier: Apache-2.0
// Fields that must be equal, and volumes with closed forms, by counting points.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "meso/implicit/field.hpp"
#include "quasi_monte_carlo.hpp"

namespace meso::implicit {
namespace {

constexpr double pi = std::numbers::pi;

Field named(std::string_view name) {
  DiagnosticSink sink;
  return *Field::surface(name, sink);
}

void expect_equal(const Field& a, const Field& b, double tolerance = 1e-12) {
  std::mt19937_64 engine(17);
  std::uniform_real_distribution<double> u(-3, 3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{u(engine), u(engine), u(engine)};
    ASSERT_NEAR(a.value(p), b.value(p), tolerance * (1 + std::abs(a.value(p)))) << p.x << " " << p.y << " " << p.z;
  }
}

const Field a = Field::box({1, 0.4, 2}), b = Field::ball(1.2).translated({0.5, 0, 0});

TEST(Identities, DeMorgan) {
  expect_equal(union_of(a, b), intersection_of(a.complement(), b.complement()).complement(), 0);
  expect_equal(difference_of(a, b), intersection_of(a, b.complement()), 0);
}

TEST(Identities, Moves) {
  expect_equal(a.translated({1, 2, 3}).translated({-0.5, 1, 0}), a.translated({0.5, 3, 3}));
  expect_equal(a.rotated({1, 2, 3}, 2 * pi), a);
  expect_equal(a.rotated({1, 2, 3}, 0.4).rotated({1, 2, 3}, 0.5), a.rotated({-2, -4, -6}, -0.9));
  expect_equal(a.scaled(2).scaled(Vec3{3, 3, 3}), a.scaled(6));
  expect_equal(a.scaled(-1), a.mirrored({1, 0, 0}).mirrored({0, 1, 0}).mirrored({0, 0, 1}));
  expect_equal(a.mirrored({1, 2, 2}).mirrored({1, 2, 2}), a);
  expect_equal(Field::cylinder().oriented({0, 3, 0}), Field::cylinder().rotated({1, 0, 0}, pi / 2));
  // The z axis goes where `oriented` says, for any direction.
  for (const Vec3 d : {Vec3{1, 2, 3}, Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{1e-7, -1e-8, -1}, Vec3{1e-200, 0, 1e-200}}) {
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const Vec3 unit = d / largest / norm(d / largest);
    EXPECT_NEAR(Field::capsule({0, 0, 0}, {0, 0, 5}, 0.1).oriented(d).value(5 * unit), -0.1, 1e-14);
  }
}

TEST(Identities, InversionSwapsTheNetworksOfTheGyroid) {
  expect_equal(named("gyroid").scaled(-1), named("gyroid").complement());
  expect_equal(named("p").offset(0.3).translated({0.5, 0.5, 0.5}), named("p").offset(-0.3).complement());
}

TEST(Identities, SkeletonsAndShells) {
  const Field f = named("iwp");
  expect_equal(f.exoskeleton(0.4), f.endoskeleton(0.4).complement(), 0);
  expect_equal(f.eccentric_shell(-0.2, 0.6), intersection_of(f.endoskeleton(0.6), f.exoskeleton(-0.2)));
  expect_equal(f.eccentric_shell(-0.3, 0.3), f.shell(0.6));
  const Field nothing = Field::ball().shell(0);
  EXPECT_EQ(nothing.value({1, 0, 0}), 0);  // zero is outside
  EXPECT_GE(nothing.interval({{-2, -2, -2}, {2, 2, 2}}).lo, 0);
}

TEST(Identities, OffsetsAfterUniformScaleAreLengthsAndBeforeItAreNot) {
  expect_equal(Field::ball().scaled(3).offset(0.5), Field::ball(3.5));
  expect_equal(Field::ball().offset(0.5).scaled(3), Field::ball(4.5));
  // A level before a scale is a share of volume, whatever the scale: f_k(p) = k (f(p / k) - level).
  EXPECT_NEAR(QuasiMonteCarlo({{-1, -1, -1}, {1, 1, 1}}).volume(named("p").offset(0.35).scaled(0.5), 40000) / 8, 0.5999,
              2e-3);
}

struct Solid {
  const char* name;
  Field field;
  Box3 box;
  double volume;
};

TEST(Identities, VolumesOfClosedForm) {
  const Box3 two{{-1, -1, -1}, {1, 1, 1}}, four{{-2, -2, -2}, {2, 2, 2}}, eight{{-4, -4, -4}, {4, 4, 4}};
  const Field pair = union_of(Field::cylinder().translated({0, -2, 0}), Field::cylinder().translated({0, 2, 0}));
  DiagnosticSink sink;
  const Solid solids[] = {
      {"ball", Field::ball(), two, 4 * pi / 3},
      {"cylinder in a box", Field::cylinder(), two, 2 * pi},
      {"cone", Field::cone(1, 0, 1), two, pi / 3},
      {"frustum", Field::cone(1, 0.5, 1), two, pi * 1.75 / 3},
      {"torus", Field::torus(0.7, 0.3), two, 2 * pi * pi * 0.7 * 0.09},
      {"capsule", Field::capsule({0, 0, -0.5}, {0, 0, 0.5}, 0.5), two, pi * 0.25 + pi / 6},
      {"half-space", Field::half_space({1, 1, 1}, 1 / std::sqrt(3.0)), two, 8 - 8.0 / 6},
      {"plane by expression", *Field::expression("x+y+z-1", sink), two, 8 - 8.0 / 6},
      {"hollow ball", Field::ball().shell(0.2), four, 4 * pi / 3 * (1.331 - 0.729)},
      {"round box", Field::box().offset(0.25), four, 8 + 24 * 0.25 + 6 * pi * 0.0625 + 4 * pi / 3 * 0.015625},
      {"ellipsoid", Field::ball().scaled(Vec3{1, 2, 3}), eight, 8 * pi},
      {"box without ball", difference_of(Field::box().scaled(2), Field::ball()), four, 64 - 4 * pi / 3},
      {"box without ball, by complement", Field::ball().complement(), two, 8 - 4 * pi / 3},
      {"bar", Field::cylinder().oriented({1, 0, 0}).scaled(0.5), two, pi / 2},
      {"hourglass", intersection_of(pair.scaled(0.5).oriented({1, 0, 0}).complement(), Field::box()), two, 8 - pi / 2},
      {"ball halved by the gyroid", intersection_of(Field::ball().scaled(4), named("gyroid").scaled(4)), eight,
       0.5 * 4 * pi / 3 * 64},
      {"eccentric gyroid", named("gyroid").offset(0.25).shell(0.5), two, 8 * (0.66178 - 0.5)},
      {"ball cut by its box", Field::ball(5), eight, 500 * pi / 3 - 6 * 14 * pi / 3},
  };
  for (const Solid& solid : solids) {
    const Vec3 size = solid.box.max - solid.box.min;
    EXPECT_NEAR(QuasiMonteCarlo(solid.box).volume(solid.field, 100000), solid.volume, 1e-3 * size.x * size.y * size.z)
        << solid.name;
  }
}

// Where the field is a distance, it is one; where it is a bound, it is no more than one.
TEST(Identities, StretchedBallBoundsTheDistanceToTheEllipsoid) {
  const Vec3 k{1, 2, 3};
  const Field f = Field::ball().scaled(k);
  std::vector<Vec3> surface;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 120; ++j) {
      const double t = pi * (i + 0.5) / 60, s = 2 * pi * j / 120;
      surface.push_back({std::sin(t) * std::cos(s), 2 * std::sin(t) * std::sin(s), 3 * std::cos(t)});
    }
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> u(-4, 4);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p{u(engine), u(engine), u(engine)};
    double distance = HUGE_VAL;
    for (const Vec3 q : surface) distance = std::min(distance, norm(p - q));
    EXPECT_LE(std::abs(f.value(p)), distance + 1e-12);
  }
}

// Ball, P, D and gyroid, each inside the one before: nested in any order, the same body.
TEST(Identities, NestingInAnyOrderIsTheSameBody) {
  const Field ball = Field::ball().scaled(5);
  const Field p = named("p").scaled(4), d = named("d").scaled(3.75), g = named("gyroid").scaled(1.25);
  expect_equal(intersection_of(intersection_of(intersection_of(ball, p), d), g),
               intersection_of(ball, intersection_of(p, intersection_of(d, g))), 0);
}

}  // namespace
}  // namespace meso::implicit
