// SPDX-License-Identifier: Apache-2.0
#include "meso/expr/nearest.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace meso::expr {
namespace {

constexpr std::array<std::string_view, 5> words = {"floor", "ceil", "sin", "asin", "pitch"};

TEST(Nearest, FindsOneSlip) {
  EXPECT_EQ(nearest("flor", words), "floor");
  EXPECT_EQ(nearest("ciel", words), "ceil");
  EXPECT_EQ(nearest("sinn", words), "sin");
  EXPECT_EQ(nearest("picth", words), "pitch");
}

TEST(Nearest, IgnoresCase) { EXPECT_EQ(nearest("PITCH", words), "pitch"); }

TEST(Nearest, SaysNothingRatherThanNonsense) {
  EXPECT_EQ(nearest("radius", words), "");
  EXPECT_EQ(nearest("x", words), "");
  EXPECT_EQ(nearest("", words), "");
  EXPECT_EQ(nearest(std::string(100000, 'x'), words), "");
}

TEST(Nearest, TakesTheFirstOfEquals) {
  constexpr std::array<std::string_view, 2> twins = {"node1", "node2"};
  EXPECT_EQ(nearest("node3", twins), "node1");
}

}  // namespace
}  // namespace meso::expr
