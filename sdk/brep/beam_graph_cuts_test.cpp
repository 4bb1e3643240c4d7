// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }
double between(Vec3 a, Vec3 b) { return std::acos(std::min(1.0, dot(unit(a), unit(b)))); }

/// Along the diagonals of a cube, upwards only if there are four.
std::vector<BallCap> diagonals(int count, double angle) {
  std::vector<BallCap> caps;
  for (int k = 0; k < count; ++k)
    caps.push_back({unit({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? -1.0 : 1.0}), angle});
  return caps;
}
const double touching = std::asin(1 / std::sqrt(3.0));  // of circles about neighbouring diagonals

Vec3 site(const std::vector<BallCap>& caps, const BallCuts& made, std::uint32_t number) {
  return number < caps.size() ? caps[number].axis : made.points[number - caps.size()];
}

/// Euler's formula: so many faces with one border each.
std::size_t faces_of(const std::vector<BallCap>& caps, const BallCuts& made, std::size_t contacts) {
  return made.cuts.size() + contacts + 2 - caps.size() - made.points.size();
}

TEST(BallCuts, CirclesThatKeepApartNeedNone) {
  EXPECT_TRUE(cuts_between(diagonals(8, touching - 0.06)).cuts.empty());
  EXPECT_TRUE(cuts_between({{{0, 0, 1}, 0.5}}).cuts.empty());
}

TEST(BallCuts, CirclesThatTouchAllAroundNeedNone) {
  const BallCuts made = cuts_between(diagonals(8, touching));
  EXPECT_TRUE(made.cuts.empty() && made.points.empty());
}

TEST(BallCuts, NecksAreCut) {
  const auto caps = diagonals(8, touching - 1e-3);
  const BallCuts made = cuts_between(caps);
  EXPECT_EQ(made.cuts.size(), 12u);  // the edges of the cube
  EXPECT_TRUE(made.points.empty());
  for (const auto& [a, b] : made.cuts) EXPECT_NEAR(dot(caps[a].axis, caps[b].axis), 1.0 / 3, 1e-12);
}

TEST(BallCuts, WhereNoCapIsNearPointsDivide) {
  for (const auto& caps : {diagonals(4, touching), diagonals(2, touching), diagonals(4, touching - 0.01)}) {
    const BallCuts made = cuts_between(caps);
    ASSERT_FALSE(made.points.empty());
    for (const Vec3& p : made.points)
      for (const BallCap& cap : caps) EXPECT_GT(between(p, cap.axis), cap.angle + 0.3);
    EXPECT_LE(faces_of(caps, made, caps[0].angle == touching ? (caps.size() == 4 ? 4 : 1) : 0), 6u);
  }
}

TEST(BallCuts, ASickleIsDividedHoweverNarrow) {
  for (const double bend : {1.2, 0.4, 0.1, 1e-2, 1e-3, 1e-5})
    for (const double gap : {0.0, 1e-6, 1e-3, 0.04})
      for (const double larger : {0.0, 0.1, 0.4}) {
        const double angle = (pi - bend - gap) / 2;
        const std::vector<BallCap> caps{{{0, 0, 1}, angle + larger},
                                        {{std::sin(bend), 0, -std::cos(bend)}, angle - larger}};
        const BallCuts made = cuts_between(caps);
        ASSERT_FALSE(made.cuts.empty()) << bend << ' ' << gap << ' ' << larger;
        for (const Vec3& p : made.points)
          for (const BallCap& cap : caps) EXPECT_GT(angle_between(p, cap.axis), cap.angle);
        // None runs through the other circle.
        for (const auto& [a, b] : made.cuts) {
          const Vec3 u = site(caps, made, a), v = site(caps, made, b);
          for (std::uint32_t k = 0; k < 2; ++k)
            for (int i = 0; k != a && k != b && i <= 20; ++i)
              EXPECT_GT(angle_between(unit((1 - i / 20.0) * u + (i / 20.0) * v), caps[k].axis), caps[k].angle);
        }
        EXPECT_GE(faces_of(caps, made, gap == 0 ? 1 : 0), 2u);
      }
}

TEST(BallCuts, AZoneIsLeftWhole) {
  EXPECT_TRUE(cuts_between({{{0, 0, 1}, pi / 2 - 0.01}, {{0, 0, -1}, pi / 2 - 0.01}}).cuts.empty());
}

TEST(BallCuts, NoCutMeetsACapOrAnother) {
  std::vector<BallCap> caps;  // struts that no symmetry has
  for (int i = 0; i < 11; ++i) {
    const double h = 0.9 - 0.16 * i, turn = 1.7 * i * i + i;
    caps.push_back({{std::sqrt(1 - h * h) * std::cos(turn), std::sqrt(1 - h * h) * std::sin(turn), h}, 0});
  }
  double nearest = pi;
  for (std::size_t i = 0; i < caps.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, between(caps[i].axis, caps[k].axis));
  for (BallCap& cap : caps) cap.angle = nearest / 2 - 1e-3;
  const BallCuts made = cuts_between(caps);
  ASSERT_FALSE(made.cuts.empty());
  for (const auto& [a, b] : made.cuts) {
    const Vec3 u = site(caps, made, a), v = site(caps, made, b);
    for (int i = 0; i <= 50; ++i) {
      const Vec3 p = (1 - i / 50.0) * u + (i / 50.0) * v;
      for (std::size_t k = 0; k < caps.size(); ++k) {
        if (k == a || k == b) continue;
        EXPECT_GT(between(p, caps[k].axis), caps[k].angle);
      }
    }
    for (const auto& [c, d] : made.cuts) {
      if (c == a || c == b || d == a || d == b) continue;
      const Vec3 p = site(caps, made, c), q = site(caps, made, d), uv = cross(u, v), pq = cross(p, q);
      const bool cross_planes = dot(uv, p) * dot(uv, q) < 0 && dot(pq, u) * dot(pq, v) < 0;
      EXPECT_FALSE(cross_planes && dot(unit(u + v), unit(p + q)) > 0);
    }
  }
}

}  // namespace
}  // namespace meso::brep
