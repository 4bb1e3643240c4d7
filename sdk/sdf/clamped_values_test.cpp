// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/clamped_values.hpp"

#include <gtest/gtest.h>

namespace meso::sdf {
namespace {

constexpr Box3 cube{{-1, -1, -1}, {1, 1, 1}};

struct Found {
  std::string text;
  double least, most, part;
};

std::vector<Found> found(const std::string& line, const Box3& box = cube) {
  DiagnosticSink sink;
  const auto program = parse_program(*words_of_text(line, "line", sink), {}, sink);
  EXPECT_TRUE(program) << line;
  std::vector<Found> result;
  if (program)
    for (const Clamped& c : clamped_values(*program, box)) result.push_back({c.made_by->text, c.least, c.most, c.part});
  return result;
}

TEST(ClampedValues, TellHowFarAndHowMuch) {
  const auto half = found("tpms.gyroid density '0.5 + x'");
  ASSERT_EQ(half.size(), 1u);
  EXPECT_EQ(half[0].text, "0.5 + x");
  EXPECT_DOUBLE_EQ(half[0].least, -0.5);
  EXPECT_DOUBLE_EQ(half[0].most, 1.5);
  EXPECT_NEAR(half[0].part, 0.5, 1.0 / 33);  // |x| > 0.5
  const auto weight = found("tpms.gyroid tpms.d blend '2*x'", {{0, 0, 0}, {1, 1, 1}});
  ASSERT_EQ(weight.size(), 1u);
  EXPECT_DOUBLE_EQ(weight[0].most, 2);
  EXPECT_NEAR(weight[0].part, 0.5, 1.0 / 33);
}

TEST(ClampedValues, AreNoneFromNoughtToOne) {
  EXPECT_TRUE(found("tpms.gyroid density '0.5 + x/2'").empty());
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend '(x + 1)/2'").empty());
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend 'clamp(9*x, 0, 1)'").empty());
  EXPECT_TRUE(found("tpms.gyroid shell '9*x'").empty());
  EXPECT_TRUE(found("tpms.gyroid density 0.5").empty());
  EXPECT_TRUE(found("ball").empty());
}

TEST(ClampedValues, AreThoseWhereTheSolidStands) {
  EXPECT_TRUE(found("tpms.gyroid density '0.5 + x' scale 2").empty());  // x is from -1/2 to 1/2 there
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend '1 + x' move 2,0,0 scale 2,1,1", {{2, 0, 0}, {4, 1, 1}}).empty());
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend 'y' rotate 0,0,1 -pi/2", {{0, 0, 0}, {1, 1, 1}}).empty());
  EXPECT_EQ(found("tpms.gyroid tpms.d blend 'y' rotate 0,0,1 pi/2", {{0.1, 0, 0}, {1, 1, 1}}).size(), 1u);
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend 'x/2' cylindrical 6").empty());  // x is the radius there
  EXPECT_EQ(found("tpms.gyroid tpms.d blend 'x' mirror 1,0,0", {{0.1, 0, 0}, {1, 1, 1}}).size(), 1u);
  EXPECT_TRUE(found("tpms.gyroid tpms.d blend '0.5 + x' repeat 1,0,0", {{3, 0, 0}, {5, 1, 1}}).empty());
}

TEST(ClampedValues, AreToldInTheOrderOfTheWords) {
  const auto both = found("tpms.gyroid density '3*x' tpms.d density '4*x' union tpms.p blend '5*x'");
  ASSERT_EQ(both.size(), 3u);
  EXPECT_EQ(both[0].text, "3*x");
  EXPECT_EQ(both[1].text, "4*x");
  EXPECT_EQ(both[2].text, "5*x");
}

TEST(ClampedValues, OfADeepStackTakeNoTime) {
  std::string line = "tpms.gyroid density '3*x'";
  for (int n = 0; n < 60; ++n) line += " dup move 0,0,1 union";  // 2^60 copies
  EXPECT_EQ(found(line).size(), 1u);
}

}  // namespace
}  // namespace meso::sdf
