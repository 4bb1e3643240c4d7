// SPDX-License-Identifier: Apache-2.0
#include "meso/membership/volume_estimate.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "document_for_test.hpp"

namespace meso::membership {
namespace {

const Membership& ball() {
  static const Membership part = membership_of(macrostructure("<sphere radius='1'/>") + part_of(""));
  return part;
}
constexpr double volume = 4 * std::numbers::pi / 3;

TEST(VolumeEstimate, IsOffByThreeDeviationsSeldomAndTheyAreNotTooLarge) {
  int beyond_one = 0, beyond_three = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const JitteredPoints points({{-1.1, -1.2, -1}, {1.2, 1.1, 1.3}}, 8000, seed);
    const auto answers = answers_at(ball(), points, {});
    ASSERT_TRUE(answers);
    const VolumeEstimate found = estimate_volume(points, *answers);
    beyond_one += std::abs(found.low - volume) > found.deviation;
    beyond_three += std::abs(found.low - volume) > 3 * found.deviation;
    EXPECT_LT(found.deviation, 0.02 * volume);  // plain Monte Carlo: 0.016 of the box
  }
  EXPECT_EQ(beyond_three, 0);
  EXPECT_GT(beyond_one, 3);  // 19 of 60 if the deviation were exact; it errs on the large side
}

TEST(VolumeEstimate, DoesNotDependOnJobs) {
  const JitteredPoints points({{-1, -1, -1}, {1, 1, 1}}, 100'000, 5);
  EXPECT_EQ(answers_at(ball(), points, {.jobs = 1}), answers_at(ball(), points, {.jobs = 3}));
}

TEST(VolumeEstimate, IsTheSameWithoutKeptAnswers) {
  const JitteredPoints points({{-1, -1, -1}, {1.5, 1, 1}}, 100'000, 5);
  const auto answers = answers_at(ball(), points, {});
  ASSERT_TRUE(answers);
  const VolumeEstimate kept = estimate_volume(points, *answers);
  for (const unsigned jobs : {1u, 3u}) {
    const auto found = estimate_volume(ball(), points, {.jobs = jobs});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->low, kept.low);
    EXPECT_EQ(found->deviation, kept.deviation);
  }
}

TEST(VolumeEstimate, PointsStandInTheirOwnCells) {
  const JitteredPoints points({{0, 0, 0}, {8, 4, 2}}, 64, 3);
  ASSERT_EQ(points.size(), 64u);
  EXPECT_DOUBLE_EQ(points.volume_each(), 1);
  for (std::size_t i = 0; i < 64; ++i) {
    const Vec3 p = points[i];
    EXPECT_EQ(std::floor(p.x) * 8 + std::floor(p.y) * 2 + std::floor(p.z), static_cast<double>(i));
  }
}

TEST(VolumeEstimate, AStopIsObeyed) {
  const JitteredPoints points({{-1, -1, -1}, {1, 1, 1}}, 1'000'000, 5);
  RunOptions run;
  run.cancelled = [] { return true; };
  EXPECT_FALSE(answers_at(ball(), points, run));
  EXPECT_FALSE(estimate_volume(ball(), points, run));
}

}  // namespace
}  // namespace meso::membership
