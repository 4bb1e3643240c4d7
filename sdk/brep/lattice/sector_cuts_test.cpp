// SPDX-License-Identifier: Apache-2.0
#include "lattice/sector_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }

/// A circle about the middle of an eighth of a ball, so far from its three sides.
std::vector<BallCap> eighth(double gap) {
  return {{{-1, 0, 0}, pi / 2},
          {{0, -1, 0}, pi / 2},
          {{0, 0, -1}, pi / 2},
          {unit({1, 1, 1}), std::asin(1 / std::sqrt(3.0)) - gap}};
}
const std::vector<bool> of_eighth{true, true, true, false};

TEST(SectorCuts, CirclesThatTouchAllSidesNeedNone) { EXPECT_TRUE(sector_cuts(eighth(0), of_eighth).empty()); }
TEST(SectorCuts, CirclesFarFromAllSidesNeedNone) { EXPECT_TRUE(sector_cuts(eighth(0.03), of_eighth).empty()); }
TEST(SectorCuts, NecksAreCut) { EXPECT_EQ(sector_cuts(eighth(1e-3), of_eighth).size(), 3u); }

// A single cut would be passed twice by the one face beside it.
TEST(SectorCuts, ACutOrContactHasAnotherToCloseTheRing) {
  for (const double gap : {0.0, 1e-3}) {
    // Half a ball, a strut near the side, two struts in the side.
    const std::vector<BallCap> caps{{{0, 0, -1}, pi / 2},
                                    {unit({0, -1, 1}), pi / 4 - gap},
                                    {unit({-1, 1, 0}), pi / 4 - 0.1},
                                    {unit({1, 1, 0}), pi / 4 - 0.1}};
    const auto made = sector_cuts(caps, {true, false, true, true});
    EXPECT_EQ(made.size(), gap > 0 ? 2u : 1u);
    for (const auto& [a, b] : made) EXPECT_TRUE(a == 1 || b == 1);
  }
}

// Half a ball has no axis that keeps off it: two struts and the side are linked all around.
TEST(SectorCuts, HalfABallIsDivided) {
  const std::vector<BallCap> caps{{{0, 0, -1}, pi / 2}, {unit({1, 0, 1}), 0.5}, {unit({-1, 0, 1}), 0.5}};
  EXPECT_TRUE(sector_cuts(caps, {true, false, false}).empty());
  EXPECT_EQ(sector_cuts(caps, {true, false, false}, Border::linked).size(), 3u);
}

// Two circles between which a third is cannot be linked past it.
TEST(SectorCuts, WhereThereIsNoRingNothingIsCut) {
  const std::vector<BallCap> caps{{{0, 0, -1}, pi / 2}, {{0, 0, 1}, 0.3}, {unit({0.62, 0, 1}), 0.25}};
  EXPECT_NEAR(angle_between(caps[1].axis, caps[2].axis) - 0.55, 0.005, 0.004);
  for (const auto& [a, b] : sector_cuts(caps, {true, false, false})) EXPECT_NE(a, b);
  EXPECT_TRUE(sector_cuts({caps[1], caps[2]}, {false, false}).empty());
}

}  // namespace
}  // namespace meso::brep
