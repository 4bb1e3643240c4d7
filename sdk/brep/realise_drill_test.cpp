// SPDX-License-Identifier: Apache-2.0
// Straight holes through plane faces need no boolean; what only looks like one gets one. Volumes in closed form.
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

class Drill : public RealiseTest {
 protected:
  /// Cutters of that shape on a grid in x and y.
  std::optional<Realisation> cut(const std::string& body, const std::string& cutter, const std::string& grid,
                                 const std::string& parameters = "") {
    return realised(macrostructure(body) + "<unitCells><unitCell id=\"u\">" + parameters + "<csg>" + cutter +
                    "</csg></unitCell></unitCells><patterns><pattern id=\"c\" unitCell=\"u\">" + grid +
                    "</pattern></patterns>" + part(R"(<apply pattern="c" operation="difference"/>)"));
  }
};

const std::string plate = R"(<box dx="60" dy="40" dz="5"/>)";
const std::string six_by_four = R"(<loop index="i" axis="x" count="6" start="5" spacing="10"/>
  <loop index="j" axis="y" count="4" start="5" spacing="10"/>)";
const std::string one = R"(<loop index="i" axis="x" count="1" start="20" spacing="1"/>
  <loop index="j" axis="y" count="1" start="20" spacing="1"/>)";

std::string cylinder(double from, double to, double radius) {
  return "<cylinder x1=\"0\" y1=\"0\" z1=\"" + std::to_string(from) + "\" x2=\"0\" y2=\"0\" z2=\"" +
         std::to_string(to) + "\" radius=\"" + std::to_string(radius) + "\"/>";
}

TEST_F(Drill, ThroughHoles) {
  const auto made = cut(plate, cylinder(-1, 6, 3), six_by_four);
  expect_body(made, "cells", 12000 - 24 * 45 * pi);
  EXPECT_EQ(made->cells.crossing, 24u);
  EXPECT_EQ(made->cells.kept, 24u);
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(measure(made->body).faces, 6u + 24u);
}

TEST_F(Drill, CuttersThatEndOnTheFaces) {
  expect_body(cut(plate, cylinder(0, 5, 3), six_by_four), "cells", 12000 - 24 * 45 * pi);
}

TEST_F(Drill, BlindHolesFromEitherSide) {
  const auto from_above = cut(plate, cylinder(2, 6, 3), six_by_four);
  expect_body(from_above, "cells", 12000 - 24 * 27 * pi);
  EXPECT_EQ(measure(from_above->body).faces, 6u + 2 * 24u);
  expect_body(cut(plate, cylinder(-3, 4, 3), six_by_four), "cells", 12000 - 24 * 36 * pi);
}

TEST_F(Drill, RadiiThatVary) {
  double removed = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 4; ++j) removed += 5 * pi * std::pow(1 + 0.3 * i + 0.5 * j, 2);
  expect_body(cut(plate, R"(<cylinder x1="0" y1="0" z1="-1" x2="0" y2="0" z2="6" radius="r"/>)", six_by_four,
                  R"(<parameter id="r" value="1 + 0.3*i + 0.5*j"/>)"),
              "cells", 12000 - removed);
}

TEST_F(Drill, ThroughBothFlangesOfAChannel) {
  const std::string channel =
      R"(<difference><box dx="60" dy="40" dz="20"/><box x="-1" y="-1" z="4" dx="62" dy="36" dz="12"/></difference>)";
  const auto made = cut(channel, cylinder(-1, 21, 3), one);
  expect_body(made, "cells", 60 * 40 * 20 - 60 * 35 * 12 - 9 * pi * 8);
  EXPECT_EQ(made->body.solids.size(), 1u);
}

TEST_F(Drill, IntoACavityWhichThenIsNoneAnyMore) {
  const std::string hollow =
      R"(<difference><box dx="40" dy="40" dz="40"/><box x="10" y="10" z="10" dx="20" dy="20" dz="20"/></difference>)";
  const auto made = cut(hollow, cylinder(20, 41, 3), one);
  expect_body(made, "cells", 64000 - 8000 - 9 * pi * 10);
  EXPECT_EQ(made->body.solids.at(0).voids.size(), 0u);
}

TEST_F(Drill, OutsideAndTouchingTakesNothing) {
  const auto made = cut(plate, cylinder(5, 9, 3), one);
  ASSERT_TRUE(made);
  EXPECT_NEAR(measure(made->body).volume, 12000, 1e-6);
}

TEST_F(Drill, AcrossAnEdgeIsCut) {
  expect_body(cut(plate, cylinder(-1, 6, 3), R"(<loop index="i" axis="x" count="1" spacing="1"/><loop index="j" axis="y"
    count="1" start="20" spacing="1"/>)"),
              "boolean", 12000 - 22.5 * pi);
}

TEST_F(Drill, BesideACutTheHolesAreFoundAgain) {
  // The first column of cutters is halved by the plate's side.
  expect_body(cut(plate, cylinder(-1, 6, 3), R"(<loop index="i" axis="x" count="6" spacing="10"/>
    <loop index="j" axis="y" count="4" start="5" spacing="10"/>)"),
              "boolean", 12000 - (20 + 2) * 45 * pi);
}

TEST_F(Drill, SlantedIsCut) {
  const auto made = cut(plate, R"(<rotate x="0" y="1" z="0" angle="30deg">)" + cylinder(-10, 20, 3) + "</rotate>", one);
  expect_body(made, "boolean", 12000 - 45 * pi / std::cos(pi / 6));
}

TEST_F(Drill, OverlappingHolesAreCutTogether) {
  // Circles of radius 3 at distance 3 share 9 (2 pi / 3 - sqrt(3) / 2).
  expect_body(cut(plate, cylinder(-1, 6, 3), R"(<loop index="i" axis="x" count="2" start="20" spacing="3"/>
    <loop index="j" axis="y" count="1" start="20" spacing="1"/>)"),
              "boolean", 12000 - 5 * 9 * (2 * pi - 2 * pi / 3 + std::sqrt(3) / 2));
}

TEST_F(Drill, FacesThatLookTheOtherWay) {
  // A mirrored box is built of reversed faces.
  const std::string mirrored =
      R"(<transform matrix="-1,0,0,60, 0,1,0,0, 0,0,1,0" mirror="true">)" + plate + "</transform>";
  expect_body(cut(mirrored, cylinder(-1, 6, 3), six_by_four), "cells", 12000 - 24 * 45 * pi);
}

TEST_F(Drill, MeshedHolesClose) {
  RealiseOptions options;
  options.mesh = true;
  const auto made =
      realised(macrostructure(plate) + "<unitCells><unitCell id=\"u\"><csg>" + cylinder(-1, 3, 3) +
                   "</csg></unitCell></unitCells><patterns><pattern id=\"c\" unitCell=\"u\">" + six_by_four +
                   "</pattern></patterns>" + part(R"(<apply pattern="c" operation="difference"/>)"),
               options);
  expect_body(made, "cells", 12000 - 24 * 27 * pi);
}

}  // namespace
}  // namespace meso::brep
