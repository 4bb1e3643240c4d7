// SPDX-License-Identifier: Apache-2.0
#include "axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meso {
namespace {

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> named;
  for (const Tick& tick : axis.ticks)
    if (!tick.label.empty()) named.push_back(tick.label);
  return named;
}

using testing::ElementsAre;

TEST(Axis, LinearBeginsAtZeroAndEndsRound) {
  EXPECT_THAT(labels(axis_for(0.7, 2.9, false)), ElementsAre("0", "0.5", "1", "1.5", "2", "2.5", "3"));
  EXPECT_THAT(labels(axis_for(280, 17920, false)), ElementsAre("0", "5k", "10k", "15k", "20k"));
  EXPECT_THAT(labels(axis_for(-3, 2, false)), ElementsAre("-3", "-2", "-1", "0", "1", "2"));
  EXPECT_THAT(labels(axis_for(0.1, 0.3, false)), ElementsAre("0", "0.05", "0.1", "0.15", "0.2", "0.25", "0.3"));
}

TEST(Axis, LogNamesTwoAndFiveWhereDecadesAreFew) {
  EXPECT_THAT(labels(axis_for(280, 17920, true)), ElementsAre("200", "500", "1k", "2k", "5k", "10k", "20k"));
  EXPECT_THAT(labels(axis_for(0.02, 30, true)), ElementsAre("0.1", "1", "10"));
}

TEST(Axis, LogNamesNoMoreThanNineOrSoOfManyDecades) {
  const std::size_t named = labels(axis_for(1e-12, 1e12, true)).size();
  EXPECT_GE(named, 4U);
  EXPECT_LE(named, 13U);
}

TEST(Axis, EveryValueIsInside) {
  for (const bool log : {false, true})
    for (const double min : {1e-7, 0.999, 1.0, 3.0, 12345.6})
      for (const double factor : {1.0, 1.0001, 2.0, 9.9, 10.0, 4e6}) {
        const Axis axis = axis_for(min, min * factor, log);
        EXPECT_LE(axis.low, min);
        EXPECT_GE(axis.high, min * factor);
        EXPECT_LT(axis.low, axis.high);
        EXPECT_GE(axis.ticks.size(), 2U) << min << " * " << factor << (log ? " log" : "");
        EXPECT_LE(axis.ticks.size(), 100U);
      }
}

TEST(Axis, FractionIsLinearOrLogarithmic) {
  EXPECT_DOUBLE_EQ(axis_for(0, 10, false).fraction(2.5), 0.25);
  EXPECT_DOUBLE_EQ(axis_for(1, 10000, true).fraction(100), 0.5);
}

}  // namespace
}  // namespace meso
