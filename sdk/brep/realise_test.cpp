// SPDX-License-Identifier: Apache-2.0
// Documents to bodies: the way each is built, and its volume against the closed form.
#include <algorithm>
#include <numbers>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

class Realise : public RealiseTest {};

/// A pattern "c" of balls of radius 1 on a grid along x, four millimetres apart.
std::string balls(int count, double start, double spacing = 4) {
  return "<unitCells><unitCell id=\"u\"><box x=\"-1\" y=\"-1\" z=\"-1\" dx=\"2\" dy=\"2\" dz=\"2\"/>"
         "<csg><sphere radius=\"1\"/></csg></unitCell></unitCells><patterns><pattern id=\"c\" unitCell=\"u\"><loop "
         "index=\"i\" axis=\"x\" count=\"" +
         std::to_string(count) + "\" start=\"" + std::to_string(start) + "\" spacing=\"" + std::to_string(spacing) +
         "\"/></pattern></patterns>";
}
const std::string block = macrostructure(R"(<box x="0" y="-5" z="-5" dx="20" dy="10" dz="10"/>)");
constexpr double ball = 4.0 / 3 * pi;

TEST_F(Realise, MacrostructureAlone) { expect_body(realised(block + part("")), "direct", 2000); }

TEST_F(Realise, EnclosedCuttersBecomeVoidsOfOneTemplate) {
  const auto made = realised(block + balls(4, 4) + part(R"(<apply pattern="c" operation="difference"/>)"));
  expect_body(made, "cells", 2000 - 4 * ball);
  ASSERT_EQ(made->body.solids.size(), 1u);
  ASSERT_EQ(made->body.solids[0].voids.size(), 4u);
  EXPECT_EQ(made->body.solids[0].voids[0].geometry, made->body.solids[0].voids[3].geometry);
  EXPECT_EQ(made->cells.placed, 4u);
  EXPECT_EQ(made->cells.kept, 4u);
  EXPECT_EQ(made->cells.crossing, 0u);
}

TEST_F(Realise, CuttersAcrossTheBoundaryAreCutAndThoseOutsideDropped) {
  // Balls at 0 (half), 4 ... 16 (whole), 20 (half), 24 (outside).
  const auto made = realised(block + balls(7, 0) + part(R"(<apply pattern="c" operation="difference"/>)"));
  expect_body(made, "boolean", 2000 - 5 * ball);
  EXPECT_EQ(made->cells.kept, 6u);
  EXPECT_EQ(made->cells.crossing, 2u);
}

TEST_F(Realise, OverlappingCutters) {
  // Unit balls at distance 1 share lenses of 5 pi / 12.
  const auto made = realised(block + balls(3, 5, 1) + part(R"(<apply pattern="c" operation="difference"/>)"));
  expect_body(made, "boolean", 2000 - (3 * ball - 2 * 5 * pi / 12));
}

TEST_F(Realise, IntersectionKeepsWhatIsInsideAndClipsTheRest) {
  const auto made = realised(block + balls(7, 0) + part(R"(<apply pattern="c" operation="intersection"/>)"));
  expect_body(made, "boolean", 5 * ball);
  EXPECT_EQ(made->body.solids.size(), 6u);
  EXPECT_EQ(made->cells.fragments, 5u);
}

TEST_F(Realise, BoundaryRules) {
  const auto apply = [](const char* rule) {
    return part(std::string(R"(<apply pattern="c" operation="intersection" boundary=")") + rule + "\"/>");
  };
  expect_body(realised(block + balls(7, 0) + apply("dropPartial")), "cells", 4 * ball);
  expect_body(realised(block + balls(7, 0) + apply("keepWhole")), "boolean", 6 * ball);
}

TEST_F(Realise, UnionOnNothing) {
  const auto made = realised(balls(3, 0) + part(R"(<apply pattern="c" operation="union"/>)", false));
  expect_body(made, "cells", 3 * ball);
  EXPECT_EQ(made->body.solids.size(), 3u);
}

TEST_F(Realise, FragmentsAreAnErrorWhereTheRuleSaysSo) {
  EXPECT_FALSE(
      realised(block + balls(7, 0) + part(R"(<apply pattern="c" operation="intersection" fragments="error"/>)")));
  EXPECT_EQ(first_code(), Code::geometry_fragments);
}

TEST_F(Realise, EmptyPart) {
  EXPECT_FALSE(realised(block + balls(2, 40) + part(R"(<apply pattern="c" operation="intersection"/>)")));
  EXPECT_EQ(first_code(), Code::geometry_empty);
  const Diagnostic& told = sink_.diagnostics().front();
  EXPECT_EQ(told.path, "/meso/parts/part[1]");
  ASSERT_EQ(told.related.size(), 1u);
  EXPECT_EQ(told.related[0].note, "pattern 'c' has its first cell at (40, 0, 0) mm");
}

TEST_F(Realise, APartWithoutCells) {
  for (const bool with_body : {true, false}) {
    const std::string apply =
        std::string("<apply pattern=\"c\" operation=\"") + (with_body ? "intersection" : "union") + "\"/>";
    EXPECT_FALSE(realised((with_body ? block : "") + balls(0, 4) + part(apply, with_body)));
    EXPECT_EQ(sink_.diagnostics().size(), 1u);
    EXPECT_EQ(first_code(), Code::geometry_empty);
    ASSERT_EQ(sink_.diagnostics().front().related.size(), 1u);
    EXPECT_EQ(sink_.diagnostics().front().related[0].note, "pattern 'c' has no cells");
  }
}

// Inside of the body's box, at the middle of a bore or at its wall.
TEST_F(Realise, AFieldInABoreMissesThePart) {
  const std::string tube =
      macrostructure(R"(<difference><box x="-9" y="-9" z="-9" dx="18" dy="18" dz="18"/>)"
                     R"(<cylinder x1="0" y1="0" z1="-10" x2="0" y2="0" z2="10" radius="5"/></difference>)");
  const auto ball_at = [](const char* x) {
    return R"(<unitCells><unitCell id="u"><box x="-1" y="-1" z="-1" dx="2" dy="2" dz="2"/><csg><sphere radius="1"/>)"
           R"(</csg></unitCell></unitCells><vectorFields><vectorField id="f"><structure records="1">)"
           R"(<component name="s"/><regularGrid><axis name="x" start=")" +
           std::string(x) +
           R"(" spacing="1" count="1"/></regularGrid></structure><embedded>AAAAAAAAAAA=</embedded></vectorField>)"
           R"(</vectorFields><patterns><pattern id="c" unitCell="u"><scatter field="f"/></pattern></patterns>)";
  };
  for (const std::string rule : {"", "boundary=\"dropPartial\""}) {
    for (const std::string operation : {"difference", "intersection"}) {
      const std::string cut = part("<apply pattern=\"c\" operation=\"" + operation + "\" " + rule + "/>");
      EXPECT_FALSE(realised(tube + ball_at("1") + cut));
      EXPECT_EQ(first_code(), Code::field_misses_part);
      EXPECT_EQ(sink_.diagnostics().size(), 1u);
    }
    EXPECT_TRUE(realised(tube + ball_at("4.5") + part("<apply pattern=\"c\" operation=\"difference\" " + rule + "/>")));
  }
  EXPECT_TRUE(realised(tube + ball_at("1") + part(R"(<apply pattern="c" operation="union"/>)")));
}

TEST_F(Realise, TooManyBooleansAreRefused) {
  RealiseOptions options;
  options.max_boolean_solids = 0;
  EXPECT_FALSE(realised(block + balls(3, 5, 1) + part(R"(<apply pattern="c" operation="difference"/>)"), options));
  EXPECT_EQ(first_code(), Code::limit_booleans);
}

TEST_F(Realise, WhyALatticeIsNoneIsToldBeforeItsBooleans) {
  RealiseOptions options;
  bool is_told = false;
  options.run.progress = [&](std::string_view, double) {
    is_told = is_told || std::ranges::any_of(sink_.diagnostics(), [](const Diagnostic& d) {
                return d.code == Code::geometry_not_repeatable;
              });
  };
  const auto made = realised(macrostructure(R"(<box x="-2" y="-2" z="-2.1" dx="5.3" dy="4" dz="4"/>)") +
                                 R"(<unitCells><unitCell id="u"><box dx="1" dy="1" dz="1"/><csg><sphere x="0.5" y="0.5"
         z="0.5" radius="2.6"/></csg></unitCell></unitCells><patterns><pattern id="c" unitCell="u"><loop index="i" axis="x"
         count="2" spacing="1"/></pattern></patterns>)" +
                                 part(R"(<apply pattern="c" operation="intersection"/>)"),
                             options);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "boolean");
  EXPECT_TRUE(is_told);
}

TEST_F(Realise, PolarSectorsInARingShareOneTemplate) {
  const auto made = realised(macrostructure(R"(<cylinder x1="0" y1="0" z1="0" x2="0" y2="0" z2="4" radius="10"/>)") +
                             R"(<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/>
         <axis name="phi" kind="circular" z="1"/><axis name="z" kind="linear" z="1"/></coordinateSystem></coordinateSystems>
         <unitCells><unitCell id="u"><box dx="1" dy="1" dz="1"/><csg><box x="0.1" y="0.1" z="0.1" dx="0.8" dy="0.8"
         dz="0.8"/></csg></unitCell></unitCells>
         <patterns><pattern id="c" unitCell="u" coordinateSystem="polar" mapping="conformal">
         <loop index="i" axis="r" count="2" start="3" spacing="3"/><loop index="j" axis="phi" count="8"
         spacing="45deg"/><loop index="k" axis="z" count="1" spacing="4"/></pattern></patterns>)" +
                             part(R"(<apply pattern="c" operation="difference"/>)"));
  const auto ring = [](double r0, double r1) { return (r1 * r1 - r0 * r0) * pi * 0.8 * 3.2; };
  expect_body(made, "cells", 400 * pi - ring(3.3, 5.7) - ring(6.3, 8.7));
  const auto& voids = made->body.solids.at(0).voids;
  ASSERT_EQ(voids.size(), 16u);
  EXPECT_EQ(voids[0].geometry, voids[7].geometry);
  EXPECT_NE(voids[0].geometry, voids[8].geometry);
}

TEST_F(Realise, AlignedLattice) {
  const auto made =
      realised(macrostructure(R"(<box dx="10" dy="10" dz="15"/>)") +
               R"(<unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/><beams radius="0.5" nodeRadius="0.9">
         <node id="a" x="0" y="0" z="0"/><node id="b" x="5" y="0" z="0"/><node id="c" x="0" y="5" z="0"/>
         <node id="d" x="5" y="5" z="0"/><node id="e" x="0" y="0" z="5"/><node id="f" x="5" y="0" z="5"/>
         <node id="g" x="0" y="5" z="5"/><node id="h" x="5" y="5" z="5"/><node id="m" x="2.5" y="2.5" z="2.5"/>
         <beam from="a" to="m"/><beam from="b" to="m"/><beam from="c" to="m"/><beam from="d" to="m"/>
         <beam from="e" to="m"/><beam from="f" to="m"/><beam from="g" to="m"/><beam from="h" to="m"/></beams></unitCell>
         </unitCells><patterns><pattern id="c" unitCell="u"><loop index="i" axis="z" count="4" spacing="5"/><loop
         index="j" axis="x" count="3" spacing="5"/><loop index="k" axis="y" count="2" spacing="5"/></pattern></patterns>)" +
               part(R"(<apply pattern="c" operation="intersection"/>)"));
  expect_body(made, "lattice", 12 * 22.928246067499);
  EXPECT_EQ(made->cells.placed, 24u);
  EXPECT_EQ(made->cells.kept, 12u);
  EXPECT_EQ(made->body.solids.size(), 1u);
}

TEST_F(Realise, BeamsWithoutExtentAreOneError) {
  for (const std::string beam : {"x=\"1.0000005\"/><beam", "x=\"4\"/><beam radius=\"1e-7\""}) {
    EXPECT_FALSE(realised(R"(<unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/><beams radius="0.5">
         <node id="a" x="1" y="1" z="1"/><node id="b" y="1" z="1" )" +
                          beam + R"( from="a" to="b"/></beams></unitCell></unitCells><patterns><pattern id="c"
         unitCell="u"><loop index="i" axis="x" count="2" spacing="5"/></pattern></patterns>)" +
                          part(R"(<apply pattern="c" operation="union"/>)", false)));
    EXPECT_EQ(sink_.diagnostics().size(), 1u);
    EXPECT_EQ(first_code(), Code::geometry_size);
    EXPECT_NE(message(sink_.diagnostics().front()).find(" of the beam at (1 1 1) mm must"), std::string::npos);
    EXPECT_GT(sink_.diagnostics().front().where.line, 0u);
  }
}

// What the outermost cells send over the pattern's rim is in boxes that no cell has.
TEST_F(Realise, NoMoreCellsAreKeptThanArePlaced) {
  const auto made = realised(macrostructure(R"(<box x="-1.2" y="-1.3" z="-1.4" dx="13" dy="8" dz="8"/>)") +
                             R"(<unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/><beams radius="0.5"
         nodeRadius="1"><node id="a" x="0" y="2.5" z="2.5"/><node id="b" x="5" y="2.5" z="2.5"/>
         <beam from="a" to="b"/></beams></unitCell></unitCells><patterns><pattern id="c" unitCell="u">
         <loop index="i" axis="x" count="2" spacing="5"/></pattern></patterns>)" +
                             part(R"(<apply pattern="c" operation="intersection"/>)"));
  // Three balls, and two struts between the planes in which they leave them.
  const double h = 1 - std::sqrt(0.75), cap = pi * h * h * (3 - h) / 3;
  expect_body(made, "lattice", 3 * ball - 4 * cap + 2 * pi * 0.25 * (5 - 2 * (1 - h)));
  EXPECT_EQ(made->cells.placed, 2u);
  EXPECT_EQ(made->cells.kept, 2u);
  EXPECT_EQ(made->cells.crossing, 0u);
}

}  // namespace
}  // namespace meso::brep
