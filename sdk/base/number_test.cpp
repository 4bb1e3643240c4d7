// SPDX-License-Identifier: Apache-2.0
#include "meso/base/number.hpp"

#include <gtest/gtest.h>

namespace meso {
namespace {

TEST(ParseNumber, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+2"), 2.0);
  EXPECT_EQ(parse_number("-.5e3"), -500.0);
  for (const char* bad : {"", " 1", "1 ", "1,5", "0x10", "+-1", "++1", "1e", "abc"})
    EXPECT_FALSE(parse_number(bad)) << bad;
}

TEST(ParseNumber, RefusesWhatIsNotFinite) {
  for (const char* bad : {"nan", "NaN", "inf", "-inf", "1e999"}) EXPECT_FALSE(parse_number(bad)) << bad;
}

TEST(FormatNumber, IsTheShortestTextThatReadsBack) {
  EXPECT_EQ(format_number(0.1), "0.1");
  EXPECT_EQ(format_number(5), "5");
  EXPECT_EQ(parse_number(format_number(1.0 / 3)), 1.0 / 3);
}

}  // namespace
}  // namespace meso
