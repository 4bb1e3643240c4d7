// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/compile.hpp"

#include <gtest/gtest.h>

#include "fields_for_test.hpp"

namespace meso::implicit {
namespace {

TEST(Compile, SamplesAreTheTermsValues) {
  const Term gyroid = term_of("cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)");
  const Grid grid{.box = {{-1, -0.5, 0}, {1, 0.7, 0.3}}, .nodes = {77, 21, 9}};
  for (const bool strict : {false, true}) {
    const auto source = compile(gyroid, grid, {.strict_math = strict});
    const Samples samples(*source, 8);
    for (std::int32_t k = 0; k < 9; ++k)
      for (std::int32_t j = 0; j < 21; ++j)
        for (std::int32_t i = 0; i < 77; ++i) {
          const std::size_t row = std::size_t(k * 21 + j);
          const double truth = gyroid.value(grid.node(i, j, k));
          EXPECT_NEAR(samples.values[row * 128 + std::size_t(i)], truth, 1e-7);
          if (std::abs(truth) < 1e-14) continue;
          EXPECT_EQ(samples.inside[row * 2 + std::size_t(i) / 64] >> i % 64 & 1, truth < 0 ? 1U : 0U);
        }
  }
}

}  // namespace
}  // namespace meso::implicit
