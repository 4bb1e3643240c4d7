// SPDX-License-Identifier: Apache-2.0
// Lattices whose struts differ from cell to cell, cut by bodies: closed forms of pillars.
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
using RealiseVaried = RealiseTest;

/// A pillar in the middle of each cell of 4 mm, 3 x 1 x 2 of them.
std::string pillars(const std::string& set) {
  return R"(<unitCells><unitCell id="u"><parameter id="r" value="0.5"/><box dx="4" dy="4" dz="4"/><beams radius="r" cap="butt">
    <node id="a" x="2" y="2" z="0"/><node id="b" x="2" y="2" z="4"/><beam from="a" to="b"/></beams></unitCell></unitCells>
    <patterns><pattern id="c" unitCell="u"><loop index="i" axis="x" count="3" spacing="4"/>
    <loop index="j" axis="y" count="1" spacing="4"/><loop index="k" axis="z" count="2" spacing="4"/>)" +
         set + "</pattern></patterns>" + part(R"(<apply pattern="c" operation="intersection"/>)");
}
std::string block(const std::string& z, const std::string& dz) {
  return macrostructure("<box z=\"" + z + "\" dx=\"12\" dy=\"4\" dz=\"" + dz + "\"/>");
}

TEST_F(RealiseVaried, RadiiByCell) {
  const std::string by_index = R"(<set parameter="r" value="0.5 + 0.1*i"/>)";
  const double area = pi * (0.25 + 0.36 + 0.49);
  const auto whole = realised(block("0", "8") + pillars(by_index));
  expect_body(whole, "lattice", 8 * area);
  EXPECT_EQ(whole->body.solids.size(), 3u);
  EXPECT_EQ(whole->cells.kept, 6u);
  expect_body(realised(block("1", "6.3") + pillars(by_index)), "lattice", 6.3 * area);
}

TEST_F(RealiseVaried, RadiiThatStepFromCellToCell) {
  // Walls that meet in part only are beyond boxes.
  const auto stepped = realised(block("0", "8") + pillars(R"(<set parameter="r" value="0.5 + 0.2*k"/>)"));
  expect_body(stepped, "boolean", 3 * 4 * pi * (0.25 + 0.49));
}

TEST_F(RealiseVaried, RadiiAtNodes) {
  const auto frustum = [](double a, double b, double height) { return pi * height / 3 * (a * a + a * b + b * b); };
  const std::string by_height = R"(<set parameter="r" value="0.5 + 0.05*global.z" at="node"/>)";
  expect_body(realised(block("0", "8") + pillars(by_height)), "lattice", 3 * frustum(0.5, 0.9, 8));
  expect_body(realised(block("1", "6") + pillars(by_height)), "lattice", 3 * frustum(0.55, 0.85, 6));
}

TEST_F(RealiseVaried, RadiiThatAreSetButEqual) {
  const auto made = realised(block("0", "8") + pillars(R"(<set parameter="r" value="0.7" at="node"/>)"));
  expect_body(made, "lattice", 3 * 8 * pi * 0.49);
}

TEST_F(RealiseVaried, BeamsThatStandCloserThanTheirBoxesOrFartherApart) {
  const auto spaced = [](const std::string& x, const std::string& z) {
    std::string text = pillars("");
    text.replace(text.find("spacing=\"4\""), 11, "spacing=\"" + x + "\"");
    text.replace(text.rfind("spacing=\"4\""), 11, "spacing=\"" + z + "\"");
    return text;
  };
  // Pillars from 0 to 4 and from 5 to 9, cut at 7; then from 0 to 7, beside each other 3 mm apart.
  expect_body(realised(block("1", "6") + spaced("4", "5")), "lattice", 3 * 5 * pi * 0.25);
  expect_body(realised(block("0", "7") + spaced("3", "3")), "lattice", 3 * 7 * pi * 0.25);
}

}  // namespace
}  // namespace meso::brep
