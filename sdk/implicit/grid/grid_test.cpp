// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meso::implicit {
namespace {

using testing::ElementsAre;

TEST(Grid, EndsAreTheBoxesEndsToTheBit) {
  const Grid grid{.box = {{-0.1, 0, 1. / 3}, {0.7, 1, 2. / 3}}, .nodes = {7, 11, 13}};
  EXPECT_EQ(grid.node(0, 0, 0), grid.box.min);
  EXPECT_EQ(grid.node(6, 10, 12), grid.box.max);
}

TEST(Grid, TotalIsSharedOutByLength) {
  EXPECT_THAT(nodes_for_total({{-1, -1, -1}, {1, 1, 1}}, 64000), ElementsAre(40, 40, 40));
  EXPECT_THAT(nodes_for_total({{0, 0, 0}, {1, 2, 4}}, 8), ElementsAre(2, 2, 2));  // never less than two
  EXPECT_THAT(nodes_for_total({{-1, -1, 0}, {1, 1, 1e-6}}, 200), ElementsAre(10, 10, 2));
  EXPECT_THAT(nodes_for_total({{-1, -1, 0}, {1, 1, 1e9}}, 1000), ElementsAre(2, 2, 250));
  EXPECT_THAT(nodes_for_total({{0, 0, 0}, {1e150, 1e150, 1e150}}, 1000), ElementsAre(10, 10, 10));
}

}  // namespace
}  // namespace meso::implicit
