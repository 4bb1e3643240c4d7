// SPDX-License-Identifier: Apache-2.0
// Document parameters, overrides, coordinate systems.
#include <gmock/gmock.h>

#include <numbers>

#include "document_text.hpp"

namespace meso::eval {
namespace {

using testing::ElementsAre;

const std::string parameters = R"(<parameters>
  <parameter id="pitch" value="5mm" min="1mm" max="20mm"/>
  <parameter id="half" value="pitch/2"/>
</parameters>)";

TEST(Parameters, AreEvaluatedInOrder) {
  const Evaluation e = evaluation_of(parameters);
  EXPECT_EQ(e.parameter("pitch"), 5);
  EXPECT_EQ(e.parameter("half"), 2.5);
  EXPECT_FALSE(e.parameter("third"));
}

TEST(Parameters, OverridesCarryOnToLaterOnes) {
  const Evaluation e = evaluation_of(parameters, {.overrides = {{"pitch", "1cm - 2"}}});
  EXPECT_EQ(e.parameter("pitch"), 8);
  EXPECT_EQ(e.parameter("half"), 4);
}

TEST(Parameters, LengthsAreInTheDocumentsUnit) {
  const std::string free = "<parameters><parameter id='pitch' value='5mm'/></parameters>";
  EXPECT_EQ(evaluation_of(free, {.overrides = {{"pitch", "25.4mm"}}}, "inch").parameter("pitch"), 1);
}

TEST(Parameters, FaultyOverridesAreTold) {
  const auto faults = [](Override o) { return faults_of(parameters, {.overrides = {std::move(o)}}); };
  EXPECT_THAT(faults({"pich", "8"}), ElementsAre("OVERRIDE_UNKNOWN_PARAMETER"));
  EXPECT_THAT(faults({"pitch", "8 +"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_THAT(faults({"pitch", "half"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_THAT(faults({"pitch", "1/0"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_THAT(faults({"pitch", "0.5"}), ElementsAre("PARAMETER_RANGE"));
  EXPECT_THAT(faults({"pitch", "21mm"}), ElementsAre("PARAMETER_RANGE"));
  EXPECT_THAT(faults_of(parameters, {.overrides = {{"pitch", "8"}, {"pitch", "9"}}}), ElementsAre("OVERRIDE_INVALID"));
}

// R-5.3.4: what was written as a length stays one; a number without a unit, or a ratio, suits both.
TEST(Parameters, OverridesKeepToTheUnitsThatAreWritten) {
  const std::string both =
      "<parameters><parameter id='pitch' value='5mm'/><parameter id='turn' value='30deg'/></parameters>";
  const auto faults = [&](Override o) { return faults_of(both, {.overrides = {std::move(o)}}); };
  EXPECT_THAT(faults({"pitch", "5deg"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_THAT(faults({"turn", "2 + pitch"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_THAT(faults({"pitch", "1mm > 1deg ? 1 : 2"}), ElementsAre("OVERRIDE_INVALID"));
  EXPECT_EQ(evaluation_of(both, {.overrides = {{"turn", "pitch/10mm"}}}).parameter("turn"), 0.5);
  EXPECT_EQ(evaluation_of(both, {.overrides = {{"turn", "0.1*pitch"}}}).parameter("turn"), 0.5);
  EXPECT_EQ(evaluation_of(both, {.overrides = {{"pitch", "8"}}}).parameter("pitch"), 8);
}

TEST(Parameters, OverrideDiagnosticsQuoteTheOverride) {
  DiagnosticSink sink;
  auto read = read_document(meso_text(parameters), "test.meso", sink);
  const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink);
  EXPECT_FALSE(Evaluation::make(*checked, {.overrides = {{"pitch", "8mmm"}}}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_EQ(sink.diagnostics()[0].args[0], "pitch=8mmm");
}

TEST(CoordinateFrame, IsPolarInClosedForm) {
  const CoordinateFrame polar({}, {{"r", AxisKind::distance, {1, 0, 0}},
                                   {"phi", AxisKind::circular, {0, 0, 1}},
                                   {"z", AxisKind::linear, {0, 0, 1}}});
  for (const double phi : {0.0, 0.3, 2.0, -4.0}) {
    const double q[] = {2.5, phi, 7};
    expect_near(polar.point(q), {2.5 * std::cos(phi), 2.5 * std::sin(phi), 7});
    expect_near(polar.frame(q).linear.column(0), {std::cos(phi), std::sin(phi), 0});
    expect_near(polar.frame(q).linear.column(2), {0, 0, 1});
  }
}

TEST(CoordinateFrame, FirstCircularAxisIsOutermost) {
  // Longitude about z outside, latitude about -y inside: spherical coordinates.
  const CoordinateFrame sphere({}, {{"r", AxisKind::distance, {1, 0, 0}},
                                    {"lon", AxisKind::circular, {0, 0, 1}},
                                    {"lat", AxisKind::circular, {0, -1, 0}}});
  const double lon = 0.7, lat = -0.4, r = 3;
  const double q[] = {r, lon, lat};
  expect_near(sphere.point(q),
              {r * std::cos(lat) * std::cos(lon), r * std::cos(lat) * std::sin(lon), r * std::sin(lat)});
  EXPECT_FALSE(sphere.is_straight());
}

TEST(CoordinateSystems, PlacementsOfParentsMultiply) {
  // The child's origin (1, 0, 0) is turned by the parent's quarter turn about z and shifted by (10, 0, 0).
  const std::string systems = R"(<coordinateSystems>
    <coordinateSystem id="child" parent="base"><placement matrix="1,0,0,1, 0,1,0,0, 0,0,1,0"/>
      <axis name="x" kind="linear" x="2"/></coordinateSystem>
    <coordinateSystem id="base"><placement matrix="0,-1,0,10, 1,0,0,0, 0,0,1,0"/>
      <axis name="u" kind="linear" x="1"/></coordinateSystem></coordinateSystems>)";
  const auto cells =
      cells_of(pattern_text("<loop index='i' axis='x' count='2' spacing='3'/>",
                            "<csg><box dx='1' dy='1' dz='1'/></csg>", "coordinateSystem='child'", systems));
  ASSERT_EQ(cells.size(), 2U);
  expect_near(cells[0].world_from_cell.translation, {10, 1, 0});
  expect_near(cells[1].world_from_cell.translation, {10, 4, 0});
  expect_near(cells[1].world_from_cell.linear.column(0), {0, 1, 0});
}

TEST(CoordinateSystems, ObliqueAxesMoveCellsAndDoNotShearThem) {
  const std::string systems = R"(<coordinateSystems><coordinateSystem id="s"><axis name="a" kind="linear" x="1"/>
    <axis name="b" kind="linear" x="3" y="4"/></coordinateSystem></coordinateSystems>)";
  const auto cells = cells_of(
      pattern_text("<loop index='i' axis='a' count='2' spacing='2'/><loop index='j' axis='b' count='2' spacing='10'/>",
                   "<csg><box dx='1' dy='1' dz='1'/></csg>", "coordinateSystem='s'", systems));
  ASSERT_EQ(cells.size(), 4U);
  expect_near(cells[3].world_from_cell.translation, {2 + 6, 8, 0});
  EXPECT_EQ(cells[3].world_from_cell.linear, Mat3{});
}

}  // namespace
}  // namespace meso::eval
