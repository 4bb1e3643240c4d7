// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/shortest_period.hpp"

#include <gtest/gtest.h>

#include "meso/sdf/words.hpp"

namespace meso::sdf {
namespace {

double period_of(const char* line) {
  DiagnosticSink sink;
  auto words = words_of_text(line, "", sink);
  const auto program = words ? parse_program(std::move(*words), {}, sink) : std::nullopt;
  EXPECT_TRUE(program) << line;
  const auto period = program ? shortest_period(*program) : std::nullopt;
  return period ? period->length : 0;
}

TEST(ShortestPeriod, IsWhatTheWordsSay) {
  EXPECT_DOUBLE_EQ(period_of("tpms.gyroid"), 1);
  EXPECT_DOUBLE_EQ(period_of("tpms.gyroid scale 0.25 shell 0.1 move 1,2,3"), 0.25);
  EXPECT_DOUBLE_EQ(period_of("strut.bcc 0.1 scale 2,-0.5,3"), 0.5);
  EXPECT_DOUBLE_EQ(period_of("ball scale 0.1 repeat 0.4,0,3 ball intersection"), 0.4);
  EXPECT_DOUBLE_EQ(period_of("tpms.gyroid scale 2 tpms.p scale 3 ball scale 9 intersection intersection"), 2);
}

TEST(ShortestPeriod, IsNothingWhereNothingRepeatsOrItIsBent) {
  EXPECT_DOUBLE_EQ(period_of("ball"), 0);
  EXPECT_DOUBLE_EQ(period_of("expression 'sin(x)'"), 0);
  EXPECT_DOUBLE_EQ(period_of("tpms.gyroid cylindrical 12"), 0);
}

}  // namespace
}  // namespace meso::sdf
