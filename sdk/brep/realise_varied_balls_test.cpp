// SPDX-License-Identifier: Apache-2.0
// Graded lattices whose struts part on the balls of their nodes, cut by bodies through these.
#include <cmath>
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
using RealiseVariedBalls = RealiseTest;

/// 2 x 2 x 2 body-centred cells of 4 mm.
std::string body_centred(const std::string& balls, const std::string& set, bool with_body = true) {
  std::string nodes, beams;
  for (int i = 0; i < 8; ++i) {
    const auto at = [&](int bit) { return std::string(i & bit ? "4" : "0"); };
    const std::string name = "n" + std::to_string(i);
    nodes += "<node id=\"" + name + "\" x=\"" + at(1) + "\" y=\"" + at(2) + "\" z=\"" + at(4) + "\"/>";
    beams += "<beam from=\"c\" to=\"" + name + "\"/>";
  }
  return R"(<unitCells><unitCell id="u"><parameter id="r" value="0.3"/><box dx="4" dy="4" dz="4"/><beams radius="r" nodeRadius=")" +
         balls + R"("><node id="c" x="2" y="2" z="2"/>)" + nodes + beams +
         R"(</beams></unitCell></unitCells><patterns><pattern id="c" unitCell="u"><loop index="i" axis="x" count="2" spacing="4"/>
    <loop index="j" axis="y" count="2" spacing="4"/><loop index="k" axis="z" count="2" spacing="4"/>)" +
         set + "</pattern></patterns>" +
         part(with_body ? R"(<apply pattern="c" operation="intersection"/>)"
                        : R"(<apply pattern="c" operation="union"/>)",
              with_body);
}
std::string slab(const std::string& z, const std::string& dz) {
  return macrostructure("<box x=\"-5\" y=\"-5\" z=\"" + z + "\" dx=\"20\" dy=\"20\" dz=\"" + dz + "\"/>");
}
const std::string at_nodes = R"(<set parameter="r" value="0.5 - 0.02*global.z" at="node"/>)",
                  by_cell = R"(<set parameter="r" value="0.5 - 0.2*k"/>)";

// What a plane leaves below and above adds up to the lattice that no body cuts, which is put together in another way.
// Planes through the middles of automatic balls touch the struts that leave them, or are touched.
TEST_F(RealiseVariedBalls, HalvesAddUp) {
  for (const auto& [balls, set] :
       {std::pair<std::string, std::string>{"auto", at_nodes}, {"auto", by_cell}, {"1.8*r", by_cell}}) {
    const auto whole = realised(body_centred(balls, set, false));
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->way, "beamGraph");
    const double volume = measure(whole->body).volume;
    for (const auto& [at, height] : {std::pair{"4", "9"}, {"2", "7"}, {"3.37", "8.37"}}) {
      const auto below = realised(slab("-5", height) + body_centred(balls, set));
      const auto above = realised(slab(at, "20") + body_centred(balls, set));
      ASSERT_TRUE(below && above);
      EXPECT_EQ(below->way, "lattice");
      EXPECT_TRUE(audit(below->body).clean() && audit(above->body).clean());
      EXPECT_NEAR((measure(below->body).volume + measure(above->body).volume) / volume, 1, 1e-7);
    }
  }
}

// A block as large as the cells: all of its faces run through the middles of balls.
TEST_F(RealiseVariedBalls, ABlockOfWholeCells) {
  const auto made = realised(macrostructure(R"(<box dx="8" dy="8" dz="8"/>)") +
                             body_centred("auto", R"(<set parameter="r" value="0.4 + 0*k"/>)"));
  const double r = 0.4, ball = r * std::sqrt(3.0), along = std::sqrt(ball * ball - r * r), height = ball - along;
  const double cap = pi * height * height * (ball - height / 3), strut = pi * r * r * (2 * std::sqrt(3.0) - 2 * along);
  expect_body(made, "lattice", 8 * (2 * 4 * pi / 3 * ball * ball * ball + 8 * strut - 16 * cap));
}

}  // namespace
}  // namespace meso::brep
