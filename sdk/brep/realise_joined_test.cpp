// SPDX-License-Identifier: Apache-2.0
// Parts in which a lattice is one step and bodies are the others, against closed forms.
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

class RealiseJoined : public RealiseTest {
 protected:
  /// Balls of radius 1 in the middle of 3 x 3 x 2 boxes of edge 4, the steps of part "p", and bodies s, t, ... to
  /// apply.
  std::optional<Realisation> made(const std::string& attributes, const std::string& steps,
                                  const std::vector<std::string>& bodies) {
    std::string text =
        "<unitCells><unitCell id=\"u\"><box dx=\"4\" dy=\"4\" dz=\"4\"/><csg><sphere x=\"2\" y=\"2\" "
        "z=\"2\" radius=\"1\"/></csg></unitCell></unitCells><patterns><pattern id=\"c\" unitCell=\"u\">";
    for (const char* loop : {"index=\"i\" axis=\"x\" count=\"3\"", "index=\"j\" axis=\"y\" count=\"3\"",
                             "index=\"k\" axis=\"z\" count=\"2\""})
      text += std::string("<loop ") + loop + " spacing=\"4\"/>";
    text +=
        "</pattern></patterns><macrostructures><macrostructure id=\"m\"><csg><box dx=\"12\" dy=\"12\" "
        "dz=\"8\"/></csg></macrostructure>";
    std::string parts = "<parts><part id=\"p\"" + attributes + ">" + steps + "</part>";
    char name = 's';
    for (const std::string& body : bodies) {
      const std::string id(1, name++);
      text += "<macrostructure id=\"m" + id + "\"><csg>" + body + "</csg></macrostructure>";
      parts += "<part id=\"" + id + "\" macrostructure=\"m" + id + "\"/>";
    }
    return realised(text + "</macrostructures>" + parts + "</parts><build><item part=\"p\"/></build>");
  }

  static constexpr double ball = 4.0 / 3 * pi;
  const std::string block = " macrostructure=\"m\"", cut = R"(<apply pattern="c" operation="intersection"/>)",
                    join_s = R"(<apply part="s" operation="union"/>)",
                    join_t = R"(<apply part="t" operation="union"/>)",
                    low_sheet = R"(<box z="1" dx="12" dy="12" dz="1"/>)";
};

TEST_F(RealiseJoined, ASheetThroughTheMiddleOfBalls) {
  const auto one = made(block, cut + join_s, {low_sheet});
  expect_body(one, "lattice", 9 * (1.5 * ball) + 144);
  EXPECT_EQ(one->body.solids.size(), 10u);
  // The intersection leaves 18 balls of one block; a union leaves none loose.
  EXPECT_EQ(one->cells.fragments, 17u);
  EXPECT_EQ(one->cells.placed, 18u);
  EXPECT_EQ(one->cells.kept, 18u);
}

TEST_F(RealiseJoined, TwoUnionsInOrder) {
  expect_body(made(block, cut + join_s + join_t, {low_sheet, R"(<box z="6" dx="12" dy="12" dz="3"/>)"}), "lattice",
              18 * (ball / 2) + 144 + 432);
}

TEST_F(RealiseJoined, WithoutABlockAndGrownOnABody) {
  expect_body(made("", R"(<apply pattern="c" operation="union"/>)" + join_s, {low_sheet}), "lattice",
              9 * (1.5 * ball) + 144);
  // The block is the body: every ball is in it.
  expect_body(made(block, R"(<apply pattern="c" operation="union"/>)", {}), "lattice", 12 * 12 * 8);
}

TEST_F(RealiseJoined, WhatIsTakenAwayAfterwards) {
  const std::string take_t = R"(<apply part="t" operation="difference"/>)";
  const std::string half = R"(<box x="6" y="-1" z="-1" dx="9" dy="14" dz="14"/>)";
  const auto cut_lattice = made(block, cut + join_s + take_t, {low_sheet, half});
  expect_body(cut_lattice, "lattice", (9 * (1.5 * ball) + 144) / 2);
  EXPECT_EQ(cut_lattice->cells.fragments, 17u);  // of the intersection; each solid is cut to one
  expect_body(made("", R"(<apply pattern="c" operation="union"/>)" + take_t, {low_sheet, half}), "lattice", 9 * ball);
  // Without the half everything is as it was before, and of each ball that a slot goes through there are two pieces.
  const std::string slot = R"(<box x="1.9" y="-1" z="5" dx="0.2" dy="14" dz="2"/>)";
  const auto slit = made(block, cut + join_s + take_t, {low_sheet, slot});
  const double disk = 2 * pi * (0.1 - 0.001 / 3);  // of a ball, between two planes
  expect_body(slit, "lattice", 9 * (1.5 * ball) + 144 - 3 * disk);
  EXPECT_EQ(slit->cells.fragments, 17u + 3u);
}

TEST_F(RealiseJoined, AnIntersectionAfterwards) {
  expect_body(made(block, cut + join_s + R"(<apply part="t" operation="intersection"/>)",
                   {low_sheet, R"(<box x="2" y="-1" z="-1" dx="4" dy="14" dz="14"/>)"}),
              "lattice", (9 * (1.5 * ball) + 144) / 3);
}

TEST_F(RealiseJoined, RulesThatLeaveFragmentsOutAreObeyedFirst) {
  const auto one =
      made(block, R"(<apply pattern="c" operation="intersection" fragments="drop"/>)" + join_s, {low_sheet});
  ASSERT_TRUE(one);
  EXPECT_NE(one->way, "lattice");
  EXPECT_EQ(one->cells.dropped, 17u);
}

}  // namespace
}  // namespace meso::brep
