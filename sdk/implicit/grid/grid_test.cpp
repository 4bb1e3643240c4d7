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

TEST(Grid, MoreNodesThan64BitsCount) {
  const Grid grid{.box = {{0, 0, 0}, {1, 1, 1}}, .nodes = {4'000'000, 3'000'000, 2'000'000}};
  const RunOptions run{.max_memory_bytes = 3 << 20};
  DiagnosticSink sink;
  EXPECT_TRUE(fits_memory(grid, 3 << 20, "planes", run, sink));
  EXPECT_TRUE(sink.diagnostics().empty());
  EXPECT_FALSE(fits_memory(grid, (3 << 20) + 1, "planes", run, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::limit_grid_memory);
  EXPECT_THAT(sink.diagnostics()[0].args, ElementsAre("4000000 x 3000000 x 2000000", "4", "planes", "3"));
}

}  // namespace
}  // namespace meso::implicit
