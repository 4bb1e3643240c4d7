// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/thinnest_wall.hpp"

#include <gtest/gtest.h>

namespace meso::sdf {
namespace {

/// 0: none is known.
double thickness(const std::string& line) {
  DiagnosticSink sink;
  const auto program = parse_program(*words_of_text(line, "line", sink), {}, sink);
  EXPECT_TRUE(program) << line;
  if (!program) return -1;
  const auto wall = thinnest_wall(*program);
  return wall ? wall->thickness : 0;
}

TEST(ThinnestWall, IsALengthWhereTheFieldIsADistance) {
  EXPECT_EQ(thickness("ball shell 0.2"), 0.2);
  EXPECT_EQ(thickness("ball shell 0.2 box shell 0.1 union"), 0.1);
  EXPECT_EQ(thickness("ball shell 0.2 box shell 0.1 intersection"), 0.1);
  EXPECT_EQ(thickness("ball shell 0.2 box shell 0.1 difference"), 0.2);
  EXPECT_EQ(thickness("ball shell 0.25 scale -2"), 0.5);
  EXPECT_EQ(thickness("ball shell 0.25 scale 1,2,3"), 0.75);  // nowhere thicker
  EXPECT_EQ(thickness("ball shell 0.25 offset 0.125"), 0.5);
  EXPECT_EQ(thickness("ball shell 1 move 1,0,0 rotate 0,0,1 1 shell 0.5"), 0.5);
  EXPECT_EQ(thickness("ball eccentric-shell -0.25,0.5"), 0.75);
}

TEST(ThinnestWall, IsNotKnownElsewhere) {
  EXPECT_EQ(thickness("ball"), 0);
  EXPECT_EQ(thickness("ball shell 0"), 0);  // nothing is left of it
  EXPECT_EQ(thickness("ball shell 0.1 offset -0.1"), 0);
  EXPECT_EQ(thickness("tpms.gyroid shell 0.2"), 0);
  EXPECT_EQ(thickness("expression 'x' ball union shell 0.2"), 0);
  EXPECT_EQ(thickness("ball scale 1,2,3 shell 0.2"), 0);
  EXPECT_EQ(thickness("ball shell 0.2 complement"), 0);
}

}  // namespace
}  // namespace meso::sdf
