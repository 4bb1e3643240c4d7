// SPDX-License-Identifier: Apache-2.0
#include "plan.hpp"

#include <gtest/gtest.h>

#include "block_intervals.hpp"
#include "fields_for_test.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

const Grid grid{.box = {{-1, -0.5, 0}, {1, 0.7, 0.3}}, .nodes = {77, 41, 19}};

Plan plan_of(std::string_view text, std::uint64_t table_bytes) {
  Graph graph;
  const Graph::Id root = graph.from_term(term_of(text));
  return {std::move(graph), root, grid, row_kernels(InstructionSet::sse2), table_bytes};
}

/// What a table over x and y comes from is computed while it is filled, and in no row.
TEST(Plan, NothingBehindATableIsLeftToRows) {
  const std::string_view text = "max(sqrt(min((x - y)^2 + y, (x + y)^2 + x^2*y + 1)) - 0.5, x*y*z - 0.1)";
  const auto steps_of_x_and_y = [&](std::uint64_t table_bytes) {
    const Plan plan = plan_of(text, table_bytes);
    std::size_t count = 0;
    for (const Graph::Id id : plan.nodes(Plan::Where::step)) count += plan.graph()[id].axes == (x_axis | y_axis);
    return count;
  };
  EXPECT_EQ(steps_of_x_and_y(1 << 20), 1U);  // x*y, which is cheap
  EXPECT_GT(steps_of_x_and_y(0), 6U);
}

/// With a table the same samples, and intervals no wider than without.
TEST(Plan, IntervalsOfATableAreItsValues) {
  for (const std::string_view text :
       {"sin(9*sqrt(x^2 + y^2)) + z", "max(hypot(x - 0.3, y) - 0.2, z - 0.1)", "sqrt(x + y)*z + log(0 - x*y) - 0.2"}) {
    const Plan with = plan_of(text, 1 << 20), without = plan_of(text, 0);
    const FlatTerm truth(term_of(text));
    ASSERT_FALSE(with.nodes(Plan::Where::xy_table).empty());
    BlockIntervals tight(with), wide(without);
    for (const std::int32_t first : {0, 8}) {
      tight.enter_slab(first, first + 8);
      wide.enter_slab(first, first + 8);
      for (std::size_t y = 0; y < tight.y_blocks(); ++y) {
        tight.enter_blocks_of_row(y);
        wide.enter_blocks_of_row(y);
        for (std::size_t x = 0; x < tight.x_blocks(); ++x) {
          const Interval one = tight.of_block(x), other = wide.of_block(x);
          EXPECT_GE(one.lo, other.lo - 1e-12) << text;
          EXPECT_LE(one.hi, other.hi + 1e-12) << text;
          // Samples of the neighbours' rims belong to the block.
          for (std::int32_t k = first; k < first + 8; ++k)
            for (std::int32_t j = std::max(0, int(y) * 16 - 1); j < std::min(41, int(y) * 16 + 17); ++j)
              for (std::int32_t i = std::max(0, int(x) * 16 - 1); i < std::min(77, int(x) * 16 + 17); ++i) {
                const double v = truth.value(grid.node(i, j, k));
                ASSERT_TRUE(std::isnan(v) ? one.undefined : one.lo - 1e-12 <= v && v <= one.hi + 1e-12) << text;
              }
        }
      }
    }
  }
}

}  // namespace
}  // namespace meso::implicit
