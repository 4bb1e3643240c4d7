// SPDX-License-Identifier: Apache-2.0
#include "lattice/primitive_field.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace meso::brep {
namespace {

TEST(PrimitiveField, DistancesOfACone) {
  const CellPrimitive cone = Frustum{{0, 0, 0}, {0, 0, 4}, 4, 1};  // flank from (4, 0) to (1, 4): a 3-4-5 triangle
  EXPECT_DOUBLE_EQ(signed_distance(cone, {0, 0, -2}), 2);
  EXPECT_DOUBLE_EQ(signed_distance(cone, {4, 0, -3}), 3);
  EXPECT_DOUBLE_EQ(signed_distance(cone, {0, 0, 6}), 2);
  EXPECT_NEAR(signed_distance(cone, {2.5 + 4, 0, 2 + 3}), 5, 1e-12);  // straight out of the flank's middle
  EXPECT_NEAR(signed_distance(cone, {2.5 - 0.8, 0, 2 - 0.6}), -1, 1e-12);
}

TEST(PrimitiveField, BoundsOfATiltedStrutAreTight) {
  const Box3 box = bounds(Frustum{{0, 0, 0}, {3, 4, 0}, 1, 1});
  EXPECT_DOUBLE_EQ(box.min.x, -0.8);
  EXPECT_DOUBLE_EQ(box.max.y, 4.6);
  EXPECT_DOUBLE_EQ(box.max.z, 1);
}

TEST(PrimitiveField, ABallCoversStrutsUpToItsLimit) {
  // A strut along the space diagonal, seen from the octant beside its own: within the ball iff R >= sqrt(3) r.
  const Box3 box{{0, 0, 0}, {5, 5, 5}};
  const CellPrimitive strut = Frustum{{0, 0, 0}, {4, 4, -4}, 0.5, 0.5};
  EXPECT_TRUE(covered(strut, std::vector<CellPrimitive>{Ball{{0, 0, 0}, 0.87}}, box));
  EXPECT_FALSE(covered(strut, std::vector<CellPrimitive>{Ball{{0, 0, 0}, 0.86}}, box));
}

TEST(PrimitiveField, SameStrutFromEitherEnd) {
  EXPECT_TRUE(same(Frustum{{0, 0, 0}, {1, 2, 3}, 1, 2}, Frustum{{1, 2, 3}, {0, 0, 0}, 2, 1}, 1e-9));
  EXPECT_FALSE(same(Frustum{{0, 0, 0}, {1, 2, 3}, 1, 2}, Frustum{{1, 2, 3}, {0, 0, 0}, 1, 2}, 1e-9));
}

TEST(PrimitiveField, SampledVolumeOfABall) {
  const double volume = sampled_volume(std::vector<CellPrimitive>{Ball{{2, 2, 2}, 1.5}}, {{0, 0, 0}, {4, 4, 4}});
  EXPECT_NEAR(volume / (4.5 * std::numbers::pi), 1, 2e-3);
}

}  // namespace
}  // namespace meso::brep
