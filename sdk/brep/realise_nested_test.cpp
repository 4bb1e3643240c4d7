// SPDX-License-Identifier: Apache-2.0
// Parts in the cells of other parts, any number of levels deep, against closed forms.
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

class RealiseNested : public RealiseTest {};

std::string loop(const char* index, const char* axis, int count, double spacing) {
  return std::string("<loop index=\"") + index + "\" axis=\"" + axis + "\" count=\"" + std::to_string(count) +
         "\" spacing=\"" + std::to_string(spacing) + "\"/>";
}
std::string cube_of_cells(const std::string& id, const std::string& cell, int count, double spacing,
                          const std::string& statements = "") {
  return "<pattern id=\"" + id + "\" unitCell=\"" + cell + "\">" + loop("i", "x", count, spacing) +
         loop("j", "y", count, spacing) + loop("k", "z", count, spacing) + statements + "</pattern>";
}
std::string unit_cell(const std::string& id, double size, const std::string& body, const std::string& attributes = "") {
  const std::string d = std::to_string(size);
  return "<unitCell id=\"" + id + "\" " + attributes + "><box dx=\"" + d + "\" dy=\"" + d + "\" dz=\"" + d + "\"/>" +
         body + "</unitCell>";
}
std::string cells(const std::string& all) { return "<unitCells>" + all + "</unitCells>"; }
std::string patterns(const std::string& all) { return "<patterns>" + all + "</patterns>"; }
std::string union_of(const std::string& id, const std::string& pattern) {
  return "<part id=\"" + id + "\"><apply pattern=\"" + pattern + "\" operation=\"union\"/></part>";
}
/// The part that is asked for, and those it is made of.
std::string parts(const std::string& others, const std::string& asked) {
  return "<parts>" + others + asked + "</parts><build><item part=\"p\"/></build>";
}
std::string box_of(const char* id, double low, double size) {
  const std::string l = std::to_string(low), d = std::to_string(size);
  return std::string("<macrostructure id=\"") + id + "\"><csg><box x=\"" + l + "\" y=\"" + l + "\" z=\"" + l +
         "\" dx=\"" + d + "\" dy=\"" + d + "\" dz=\"" + d + "\"/></csg></macrostructure>";
}

/// Three square bars through the middle of a box of 4: 10 mm3.
const std::string bars =
    R"(<csg><box x="0" y="1.5" z="1.5" dx="4" dy="1" dz="1"/><box x="1.5" y="0" z="1.5" dx="1" dy="4" dz="1"/>)"
    R"(<box x="1.5" y="1.5" z="0" dx="1" dy="1" dz="4"/></csg>)";
const std::string ball = R"(<csg><sphere x="2" y="2" z="2" radius="1"/></csg>)";
constexpr double unit_ball = 4.0 / 3 * pi;

TEST_F(RealiseNested, CellsThatFillCellsAreOneLattice) {
  const auto made = realised(
      cells(unit_cell("u", 4, bars) + unit_cell("v", 8, "<part ref=\"a\"/>") +
            unit_cell("w", 16, "<part ref=\"b\"/>")) +
      patterns(cube_of_cells("pa", "u", 2, 4) + cube_of_cells("pb", "v", 2, 8) + cube_of_cells("pc", "w", 3, 16)) +
      parts(union_of("a", "pa") + union_of("b", "pb"), union_of("p", "pc")));
  expect_body(made, "lattice", 27 * 64 * 10);
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(made->cells.placed, 27u + 8u + 8u);
  EXPECT_LT(made->body.solids[0].outer.geometry->faces.size(), 100u);  // of one small cell
}

TEST_F(RealiseNested, CellsCutToTheirBoxesAreOneLatticeWhereNothingReachesOver) {
  // Balls in the corners: a box has eight eighths, whoever is asked for them.
  const std::string corners =
      R"(<beams radius="0.4" nodeRadius="0.8"><node id="a" x="0" y="0" z="0"/>)"
      R"(<node id="b" x="4" y="0" z="0"/><node id="c" x="0" y="4" z="0"/><node id="d" x="0" y="0" z="4"/>)"
      R"(<node id="e" x="4" y="4" z="0"/><node id="f" x="4" y="0" z="4"/><node id="g" x="0" y="4" z="4"/>)"
      R"(<node id="h" x="4" y="4" z="4"/>)"
      R"(<beam from="a" to="b"/><beam from="c" to="e"/><beam from="d" to="f"/><beam from="g" to="h"/></beams>)";
  const auto made =
      realised(cells(unit_cell("u", 4, corners) + unit_cell("v", 8, "<part ref=\"a\"/>", "clipToBox=\"true\"")) +
               patterns(cube_of_cells("pa", "u", 2, 4) + cube_of_cells("pb", "v", 2, 8)) +
               parts(union_of("a", "pa"), union_of("p", "pb")));
  // Along x a row has 5 nodes at 0 ... 16 and four struts of 4 between them, less what is in the balls.
  const double h = std::sqrt(0.8 * 0.8 - 0.4 * 0.4), cap = pi * (0.8 - h) * (0.8 - h) * (2.4 - 0.8 + h) / 3;
  const double balls = 4.0 / 3 * pi * 0.8 * 0.8 * 0.8, strut = pi * 0.16 * (4 - 2 * h) - 2 * cap;
  expect_body(made, "lattice", 16 * (4 * balls + 4 * strut));  // 5 x 5 rows, cut at the sides: as 4 x 4 whole ones
}

TEST_F(RealiseNested, CountsAreOfThePatternsOwnCells) {
  const auto made =
      realised("<macrostructures>" + box_of("m", 0, 12) + "</macrostructures>" +
               cells(unit_cell("u", 4, bars) + unit_cell("v", 8, "<part ref=\"a\"/>")) +
               patterns(cube_of_cells("pa", "u", 2, 4) + cube_of_cells("pb", "v", 3, 8)) +
               parts(union_of("a", "pa"),
                     R"(<part id="p" macrostructure="m"><apply pattern="pb" operation="intersection"/></part>)"));
  expect_body(made, "lattice", 27 * 10);  // three small boxes along each side
  EXPECT_EQ(made->cells.kept, 8u + 8u);
}

TEST_F(RealiseNested, CuttersOfSeveralSolidsAreVoids) {
  const auto made =
      realised("<macrostructures>" + box_of("m", -1, 26) + "</macrostructures>" +
               cells(unit_cell("u", 4, ball) + unit_cell("v", 8, "<part ref=\"a\"/>")) +
               patterns(cube_of_cells("pa", "u", 2, 4) + cube_of_cells("pb", "v", 3, 8)) +
               parts(union_of("a", "pa"),
                     R"(<part id="p" macrostructure="m"><apply pattern="pb" operation="difference"/></part>)"));
  expect_body(made, "cells", 26 * 26 * 26 - 216 * unit_ball);
  ASSERT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(made->body.solids[0].voids.size(), 216u);
}

TEST_F(RealiseNested, BeamsOfPartsAreOneGraph) {
  // Tripods that stand apart and are turned: no lattice.
  const std::string tripod = R"(<beams radius="0.3" nodeRadius="0.5"><node id="a" x="0" y="0" z="0"/>)"
                             R"(<node id="b" x="3" y="0" z="0"/><node id="c" x="0" y="3" z="0"/>)"
                             R"(<beam from="a" to="b"/><beam from="a" to="c"/></beams>)";
  const auto made = realised(
      cells(unit_cell("u", 3, tripod) + unit_cell("v", 8, "<part ref=\"a\"/>")) +
      patterns("<pattern id=\"pa\" unitCell=\"u\">" + loop("i", "x", 2, 3) + "</pattern>" +
               cube_of_cells("pb", "v", 2, 16, R"(<rotate z="1" x="0" y="0" angle="0.3"/><scale factor="2"/>)")) +
      parts(union_of("a", "pa"), union_of("p", "pb")));
  // A chain of three nodes along x, and two nodes beside it: five balls and four struts, twice as large.
  const double h = std::sqrt(0.5 * 0.5 - 0.3 * 0.3), cap = pi * (0.5 - h) * (0.5 - h) * (1.5 - 0.5 + h) / 3;
  const double one = 5 * unit_ball * 0.125 + 4 * (pi * 0.09 * (3 - 2 * h) - 2 * cap);
  expect_body(made, "beamGraph", 8 * 8 * one);
  EXPECT_EQ(made->body.solids.size(), 8u);
}

TEST_F(RealiseNested, BeamsOfSeveralStepsAreOneGraph) {
  // Chains along x and along y from one node: three balls each, one of them shared; then two of these.
  const std::string rod =
      R"(<beams radius="0.3" nodeRadius="0.5"><node id="a" x="0" y="0" z="0"/><node id="b" x="3" y="0" z="0"/>)"
      R"(<beam from="a" to="b"/></beams>)";
  const auto made = realised(
      cells(unit_cell("u", 3, rod) + unit_cell("v", 9, "<part ref=\"a\"/>")) +
      patterns("<pattern id=\"px\" unitCell=\"u\">" + loop("i", "x", 2, 3) +
               "</pattern><pattern id=\"py\" unitCell=\"u\">" + loop("i", "y", 2, 3) +
               R"(<rotate x="0" y="0" z="1" angle="90deg"/></pattern><pattern id="pb" unitCell="v">)" +
               loop("i", "x", 2, 6) + "</pattern>") +
      parts(R"(<part id="a"><apply pattern="px" operation="union"/><apply pattern="py" operation="union"/></part>)",
            union_of("p", "pb")));
  const double h = std::sqrt(0.5 * 0.5 - 0.3 * 0.3), cap = pi * (0.5 - h) * (0.5 - h) * (1.5 - 0.5 + h) / 3;
  expect_body(made, "beamGraph", 9 * unit_ball * 0.125 + 8 * (pi * 0.09 * (3 - 2 * h) - 2 * cap));
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(made->cells.placed, 2u + 2u + 2u);
}

TEST_F(RealiseNested, WhatIsLeftOfALatticeIsCutFurther) {
  // A block of bars, bored along z through the middles of four columns of cells, in two cells beside each other.
  const std::string bore = R"(<csg><box x="1.75" y="1.75" z="-1" dx="0.5" dy="0.5" dz="10"/></csg>)";
  const auto made = realised(
      cells(unit_cell("u", 4, bars) + unit_cell("b", 4, bore) + unit_cell("v", 8, "<part ref=\"a\"/>")) +
      patterns(cube_of_cells("pa", "u", 2, 4) + "<pattern id=\"pb\" unitCell=\"b\">" + loop("i", "x", 2, 4) +
               loop("j", "y", 2, 4) + "</pattern><pattern id=\"pc\" unitCell=\"v\">" + loop("i", "x", 2, 8) +
               "</pattern>") +
      parts(
          R"(<part id="a"><apply pattern="pa" operation="union"/><apply pattern="pb" operation="difference"/></part>)",
          union_of("p", "pc")));
  ASSERT_TRUE(made);
  EXPECT_NEAR(measure(made->body).volume, 2 * (8 * 10 - 4 * 8 * 0.25), 1e-6);
  EXPECT_TRUE(audit(made->body).clean());
}

TEST_F(RealiseNested, AnEmptyPartInACellIsNothing) {
  EXPECT_FALSE(
      realised("<macrostructures>" + box_of("m", 40, 2) + "</macrostructures>" +
               cells(unit_cell("u", 4, ball) + unit_cell("v", 4, "<part ref=\"a\"/>")) +
               patterns(cube_of_cells("pa", "u", 1, 4) + cube_of_cells("pb", "v", 2, 4)) +
               parts(R"(<part id="a" macrostructure="m"><apply pattern="pa" operation="intersection"/></part>)",
                     union_of("p", "pb"))));
  EXPECT_EQ(first_code(), Code::geometry_empty);
}

TEST_F(RealiseNested, APartThatCannotBeMadeIsToldOnce) {
  EXPECT_FALSE(realised(
      "<macrostructures>" + box_of("m", 0, 9) + "</macrostructures>" +
      cells(unit_cell("u", 4, ball) + unit_cell("v", 4, "<part ref=\"a\"/>")) +
      patterns(cube_of_cells("pa", "u", 2, 4) + cube_of_cells("pb", "v", 2, 4)) +
      parts(R"(<part id="a" macrostructure="m"><apply pattern="pa" operation="difference" radius="1"/></part>)",
            union_of("p", "pb"))));
  EXPECT_EQ(first_code(), Code::brep_not_realised);
  EXPECT_EQ(sink_.error_count(), 1u);
}

TEST_F(RealiseNested, WhatIsListedTwiceIsMadeOnce) {
  const auto made = realised(cells(unit_cell("u", 4, bars)) + patterns(cube_of_cells("pa", "u", 2, 4)) + "<parts>" +
                             union_of("p", "pa") + "</parts><build><item part=\"p\"/><item part=\"p\"><placement " +
                             "matrix=\"1, 0, 0, 20,  0, 1, 0, 0,  0, 0, 1, 0\"/></item></build>");
  expect_body(made, "lattice", 2 * 80);
  ASSERT_EQ(made->body.solids.size(), 2u);
  EXPECT_EQ(made->body.solids[0].outer.geometry, made->body.solids[1].outer.geometry);
}

}  // namespace
}  // namespace meso::brep
