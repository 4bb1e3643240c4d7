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

TEST_F(Drill, SquareHolesInAnyOfThreeDirections) {
  const auto made = cut(plate, R"(<box x="-2" y="-3" z="-1" dx="4" dy="6" dz="7"/>)", six_by_four);
  expect_body(made, "cells", 12000 - 24 * 24 * 5);
  EXPECT_EQ(made->body.solids.size(), 1u);
  expect_body(cut(plate, R"(<box x="-2" y="-3" z="2" dx="4" dy="6" dz="9"/>)", six_by_four), "cells",
              12000 - 24 * 24 * 3);
  // From the side.
  expect_body(
      cut(plate, R"(<box x="-2" y="-30" z="1" dx="4" dy="60" dz="3"/>)",
          R"(<loop index="i" axis="x" count="6" start="5" spacing="10"/><loop index="j" axis="y" count="1" start="20" spacing="1"/>)"),
      "cells", 12000 - 6 * 12 * 40.0);
}

TEST_F(Drill, SlotsNextToAnEdge) {
  // Long slots whose circles would reach over the edge of the plate, which they themselves keep clear of.
  const std::string slot = R"(<box x="-4" y="-1" z="-1" dx="8" dy="2" dz="7"/>)";
  const auto made = cut(
      plate, slot,
      R"(<loop index="i" axis="x" count="6" start="5" spacing="10"/><loop index="j" axis="y" count="13" start="2" spacing="3"/>)");
  expect_body(made, "cells", 12000 - 6 * 13 * 80);
}

TEST_F(Drill, AHoleAroundAHoleIsNotPutIn) {
  // The cutter's outline goes all round a hole of the plate: nothing of that may be left.
  const std::string holed =
      R"(<difference><box dx="60" dy="40" dz="5"/><cylinder x1="20" y1="20" z1="-1" x2="20" y2="20" z2="6" radius="2"/></difference>)";
  const auto made = cut(holed, R"(<box x="-5" y="-5" z="-1" dx="10" dy="10" dz="7"/>)", one);
  expect_body(made, "boolean", 12000 - 500);
  EXPECT_EQ(measure(made->body).faces, 10u);
}

TEST_F(Drill, SectorsThroughADiskAreTurnsOfOne) {
  const auto made = realised(macrostructure(R"(<cylinder x1="0" y1="0" z1="0" x2="0" y2="0" z2="4" radius="10"/>)") +
                             R"(<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/>
         <axis name="phi" kind="circular" z="1"/><axis name="z" kind="linear" z="1"/></coordinateSystem></coordinateSystems>
         <unitCells><unitCell id="u"><box dx="1" dy="1" dz="1"/><csg><box x="0.1" y="0.1" z="0.1" dx="0.8" dy="0.8"
         dz="0.8"/></csg></unitCell></unitCells>
         <patterns><pattern id="c" unitCell="u" coordinateSystem="polar" mapping="conformal">
         <loop index="i" axis="r" count="2" start="3" spacing="3"/><loop index="j" axis="phi" count="24"
         spacing="15deg"/><loop index="k" axis="z" count="1" start="-4" spacing="12"/></pattern></patterns>)" +
                             part(R"(<apply pattern="c" operation="difference"/>)"));
  const auto ring = [](double r0, double r1) { return (r1 * r1 - r0 * r0) * pi * 0.8 * 4; };
  expect_body(made, "cells", 400 * pi - ring(3.3, 5.7) - ring(6.3, 8.7));
  EXPECT_EQ(measure(made->body).faces, 3u + 48 * 4u);
}

}  // namespace
}  // namespace meso::brep
