// SPDX-License-Identifier: Apache-2.0
// Bodies with all numbers known.
#include <gmock/gmock.h>

#include <numbers>
#include <numeric>

#include "document_text.hpp"
#include "meso/eval/bounds.hpp"

namespace meso::eval {
namespace {

using testing::ElementsAre;

const std::string three = "<loop index='i' axis='x' count='3' start='1' spacing='1'/>";

Shape shape_of(const CellStream& stream, std::uint64_t ordinal) {
  DiagnosticSink sink;
  std::optional<Shape> shape;
  (void)stream.visit(
      ordinal, ordinal + 1, [&](const PlacedCell& c) { return shape = stream.shape(c, sink), true; }, sink);
  if (!shape) throw std::invalid_argument(render_all(sink));
  return *shape;
}
Shape shape_of(const std::string& text, std::uint64_t ordinal = 0, const std::string& unit = "millimeter") {
  return shape_of(stream_of(evaluation_of(text, {}, unit)), ordinal);
}

TEST(Csg, IsInMillimetresAndKnowsTheParameters) {
  const Shape s = shape_of(
      pattern_text(three, "<parameter id='r' value='i + 1'/><csg><sphere x='2' radius='r'/></csg>"), 2, "centimeter");
  const auto& sphere = std::get<SphereShape>(s.value);
  EXPECT_EQ(sphere.center, (Vec3{20, 0, 0}));
  EXPECT_EQ(sphere.radius, 30);
}

TEST(Csg, TransformsAndBooleansKeepTheirTree) {
  const Shape s = shape_of(pattern_text(three, R"(<csg><difference><box dx="4" dy="4" dz="4"/>
    <translate x="1"><rotate x="0" y="0" z="3" angle="90deg"><cone x1="0" y1="0" z1="0" x2="0" y2="0" z2="2" radius1="1"
      radius2="0"/></rotate></translate></difference></csg>)"));
  const auto& difference = std::get<BooleanShape>(s.value);
  EXPECT_EQ(difference.operation, BooleanOperation::difference);
  const auto& translate = std::get<TransformedShape>(difference.operands[1].value);
  EXPECT_EQ(translate.map.translation, (Vec3{1, 0, 0}));
  const auto& rotate = std::get<TransformedShape>(translate.operands[0].value);
  expect_near(rotate.map * Vec3{1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(std::holds_alternative<ConeShape>(rotate.operands[0].value));
}

TEST(Csg, RangesAreCheckedAfterEvaluation) {
  const auto faults = [](const std::string& body) {
    return faults_of(pattern_text(three, "<parameter id='r' value='1 - i'/><csg>" + body + "</csg>"));
  };
  EXPECT_THAT(faults("<sphere radius='r'/>"), ElementsAre("VALUE_NOT_POSITIVE in cell (1) of pattern 'p'"));
  EXPECT_THAT(faults("<box dx='1' dy='r' dz='1'/>"), ElementsAre("VALUE_NOT_POSITIVE in cell (1) of pattern 'p'"));
  EXPECT_THAT(faults("<torus majorRadius='1' minorRadius='2 - r'/>"),
              ElementsAre("TORUS_RADII in cell (0) of pattern 'p'"));
  EXPECT_THAT(faults("<cylinder x1='0' y1='0' z1='0' x2='0' y2='0' z2='r' radius='1'/>"),
              ElementsAre("BODY_DEGENERATE in cell (1) of pattern 'p'"));
  EXPECT_THAT(faults("<transform matrix='r,0,0,0, 0,1,0,0, 0,0,1,0'><sphere radius='1'/></transform>"),
              ElementsAre("TRANSFORM_DETERMINANT in cell (1) of pattern 'p'"));
}

TEST(Csg, WedgesArePolyhedra) {
  const auto wedge = [](const std::string& top) {
    const Shape s =
        shape_of(pattern_text(three, "<csg><wedge x='1' y='2' z='3' dx='6' dy='4' dz='3' " + top + "/></csg>"));
    Polyhedron body = std::get<PolyhedronShape>(s.value).body;
    EXPECT_FALSE(polyhedron_fault(body)) << top;
    std::vector<std::size_t> faces(body.faces.size());
    std::iota(faces.begin(), faces.end(), std::size_t{0});
    return std::pair{faces.size(), volume_of(body, faces)};  // h (A + 4 M + B) / 6
  };
  EXPECT_EQ(wedge(""), (std::pair{std::size_t{6}, 72.0}));
  EXPECT_EQ(wedge("topX='1' topY='2' topDx='2' topDy='1'"), (std::pair{std::size_t{6}, 3 * (24 + 4 * 10 + 2) / 6.0}));
  EXPECT_EQ(wedge("topX='2' topY='2' topDx='2' topDy='0'"), (std::pair{std::size_t{5}, 3 * (24 + 4 * 8) / 6.0}));
  EXPECT_EQ(wedge("topDx='0' topDy='0'"), (std::pair{std::size_t{5}, 24.0}));
  EXPECT_EQ(wedge("topDx='0'"), (std::pair{std::size_t{5}, 36.0}));
}

TEST(Csg, ProfilesAndPolyhedraAreCheckedAfterEvaluation) {
  const auto faults = [](const std::string& body) {
    return faults_of(pattern_text(three, "<parameter id='r' value='2 - i'/><csg>" + body + "</csg>"));
  };
  EXPECT_THAT(faults("<revolution><point r='0' z='0'/><point r='r - 1' z='0'/><point r='0' z='1'/></revolution>"),
              ElementsAre("REVOLUTION_PROFILE in cell (1) of pattern 'p'"));
  EXPECT_THAT(faults("<revolution><point r='0' z='0'/><point r='2*r-1' z='0'/><point r='0' z='1'/></revolution>"),
              ElementsAre("VALUE_NEGATIVE in cell (2) of pattern 'p'"));
  const auto tetrahedron = [](const std::string& height) {
    return "<polyhedron><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/><vertex x='0' "
           "y='0' z='" +
           height +
           "'/><face vertices='0, 2, 1'/><face vertices='0, 1, 3'/><face vertices='1, 2, 3'/>"
           "<face vertices='2, 0, 3'/></polyhedron>";
  };
  EXPECT_THAT(faults(tetrahedron("r")), ElementsAre("POLYHEDRON_FACE in cell (2) of pattern 'p'"));
  EXPECT_THAT(faults(tetrahedron("r + 1")), testing::IsEmpty());
  EXPECT_THAT(faults(tetrahedron("r - 1.5")), ElementsAre("POLYHEDRON_INSIDE_OUT in cell (1) of pattern 'p'"));
}

TEST(Bounds, OfRevolutionsAndPolyhedra) {
  EXPECT_EQ(bounds(Shape{RevolutionShape{{{0, -3}, {2, 0}, {0, 3}}}}), (Box3{{-2, -2, -3}, {2, 2, 3}}));
  EXPECT_EQ(bounds(Shape{PolyhedronShape{{{{0, 1, 2}, {5, -1, 0}}, {}}}}), (Box3{{0, -1, 0}, {5, 1, 2}}));
}

const std::string cross_nodes = R"(<node id="o" x="0" y="0" z="0"/><node id="a" x="3" y="0" z="0"/>
  <node id="b" x="0" y="3" z="0"/><beam from="o" to="a"/><beam from="o" to="b" radius1="0.75"/>)";

TEST(Beams, RadiiCapsAndBalls) {
  const Shape s = shape_of(pattern_text(three, "<beams radius='0.5' cap='butt'>" + cross_nodes + "</beams>"));
  const auto& beams = std::get<BeamsShape>(s.value);
  ASSERT_EQ(beams.struts.size(), 2U);
  EXPECT_EQ(beams.struts[1].radius_from, 0.75);
  EXPECT_EQ(beams.struts[1].radius_to, 0.5);
  EXPECT_EQ(beams.struts[0].cap_to, BeamCap::butt);
  EXPECT_EQ(beams.nodes[0].ball_radius, 0);
}

TEST(Beams, AutomaticBallsHoldEveryStrutsEnd) {
  const Shape s = shape_of(pattern_text(three, "<beams radius='0.5' nodeRadius='auto'>" + cross_nodes + "</beams>"));
  const auto& beams = std::get<BeamsShape>(s.value);
  EXPECT_NEAR(beams.nodes[0].ball_radius, 0.75 / std::sin(std::numbers::pi / 4), 1e-12);
  EXPECT_EQ(beams.nodes[1].ball_radius, 0.5);
}

TEST(Beams, NodeSetsSeeThePlacedNodeSoThatNeighboursAgree) {
  const CellStream stream = stream_of(evaluation_of(pattern_text(
      "<loop index='i' axis='x' count='3' spacing='3'/><set parameter='t' value='1 + global.x/10' at='node'/>",
      "<parameter id='t' value='1'/><parameter id='r' value='t/2'/><beams radius='r' nodeRadius='t'>" + cross_nodes +
          "</beams>")));
  EXPECT_TRUE(stream.shape_varies());
  const Shape first = shape_of(stream, 0), second = shape_of(stream, 1);
  const auto& left = std::get<BeamsShape>(first.value);
  const auto& right = std::get<BeamsShape>(second.value);
  EXPECT_NEAR(left.struts[0].radius_to, 0.65, 1e-12);
  EXPECT_NEAR(left.nodes[1].ball_radius, 1.3, 1e-12);
  EXPECT_EQ(left.struts[0].radius_to, right.struts[0].radius_from);
}

TEST(Macrostructure, HasItsPlacement) {
  const Evaluation e = evaluation_of(R"(<macrostructures><macrostructure id="m">
    <placement matrix="1,0,0,2, 0,1,0,0, 0,0,1,0"/><csg><sphere radius="1"/></csg></macrostructure></macrostructures>)",
                                     {}, "inch");
  DiagnosticSink sink;
  const auto shape = e.shape(e.document().macrostructures.items[0], sink);
  ASSERT_TRUE(shape) << render_all(sink);
  const auto box = bounds(*shape);
  ASSERT_TRUE(box);
  expect_near(box->min, {25.4, -25.4, -25.4});
  expect_near(box->max, {3 * 25.4, 25.4, 25.4});
}

const std::string polar = R"(<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/>
  <axis name="phi" kind="circular" z="1"/><axis name="h" kind="linear" z="1"/></coordinateSystem></coordinateSystems>)";
const std::string sectors =
    "<loop index='i' axis='r' count='2' start='2' spacing='1 + i'/><loop index='j' axis='phi' count='6' "
    "spacing='60deg'/><loop index='k' axis='h' count='1' position='5*(k + 1)'/>";

TEST(Conformal, BoxesBecomeVolumeElements) {
  const CellStream stream = stream_of(
      evaluation_of(pattern_text(sectors, "<box dx='2' dy='2' dz='2'/><csg><box x='0.5' dx='1' dy='2' dz='2'/></csg>",
                                 "mapping='conformal' coordinateSystem='polar'", polar)));
  const Shape s = shape_of(stream, 7);  // i = 1, j = 1
  const auto& e = std::get<VolumeElementShape>(s.value);
  EXPECT_NEAR(e.from[0], 3 + 0.25 * 2, 1e-12);
  EXPECT_NEAR(e.to[0], 3 + 0.75 * 2, 1e-12);
  EXPECT_NEAR(e.from[1], std::numbers::pi / 3, 1e-12);
  EXPECT_NEAR(e.to[1], 2 * std::numbers::pi / 3, 1e-12);
  EXPECT_NEAR(e.from[2], 5, 1e-12);
  EXPECT_NEAR(e.to[2], 10, 1e-12);
}

TEST(Conformal, StraightBeamsRunBetweenMappedNodes) {
  const Shape s =
      shape_of(pattern_text(sectors,
                            "<box dx='1' dy='1' dz='1'/><beams radius='0.1'><node id='a' x='1' y='0' z='0'/>"
                            "<node id='b' x='1' y='1' z='1'/><beam from='a' to='b'/></beams>",
                            "mapping='conformal' coordinateSystem='polar'", polar));
  const auto& beams = std::get<BeamsShape>(s.value);
  expect_near(beams.nodes[0].position, {3, 0, 5});
  expect_near(beams.nodes[1].position, {1.5, 3 * std::sin(std::numbers::pi / 3), 10});
}

const std::string ball_system =
    "<coordinateSystems><coordinateSystem id='ball'><axis name='rho' kind='distance' x='1'/>"
    "<axis name='phi' kind='circular' z='1'/><axis name='psi' kind='circular' y='-1'/></coordinateSystem>"
    "</coordinateSystems>";

/// So many sectors around a ball; a strut from the south pole to 15 degrees above it in the middle of each.
std::string star(int cells, const std::string& statements) {
  return pattern_text("<loop index='i' axis='rho' count='1' start='9' spacing='2'/><loop index='j' axis='phi' count='" +
                          std::to_string(cells) + "' spacing='360deg/" + std::to_string(cells) +
                          "'/><loop index='k' axis='psi' count='1' start='-90deg' spacing='30deg'/>" + statements,
                      "<parameter id='r' value='0.1'/><box dx='1' dy='1' dz='1'/><beams radius='r' nodeRadius='auto'>"
                      "<node id='a' x='0.5' y='0.5' z='0'/><node id='b' x='0.5' y='0.5' z='0.5'/><beam from='a' "
                      "to='b'/></beams>",
                      "mapping='conformal' coordinateSystem='ball'", ball_system);
}

/// Struts that rise by 7.5 degrees and are `degrees` apart around the pole.
double star_ball(double radius, double degrees) {
  const double to_rad = std::numbers::pi / 180;
  return radius / (std::cos(7.5 * to_rad) * std::sin(degrees / 2 * to_rad));
}

double ball_of(const Shape& shape, std::size_t node) {
  return std::get<BeamsShape>(shape.value).nodes.at(node).ball_radius;
}

TEST(Conformal, OnAPoleTheStrutsOfAllCellsMakeTheBall) {
  for (const int cells : {3, 8, 9, 40}) {
    const CellStream stream = stream_of(evaluation_of(star(cells, "")));
    const double ball = star_ball(0.1, 360.0 / cells);
    for (const int cell : {0, cells - 1}) {
      EXPECT_NEAR(ball_of(shape_of(stream, static_cast<std::uint64_t>(cell)), 0), ball, 1e-12) << cells;
      EXPECT_EQ(ball_of(shape_of(stream, static_cast<std::uint64_t>(cell)), 1), 0.1);
    }
  }
}

TEST(Conformal, CellsThatAreNotThereMakeNoBall) {
  const CellStream stream = stream_of(evaluation_of(star(8, "<when test='j == 2 * floor(j / 2)'/>")));
  EXPECT_NEAR(ball_of(shape_of(stream, 2), 0), star_ball(0.1, 90), 1e-12);
}

TEST(Conformal, TheThickestStrutsOfAPoleMakeItsBall) {
  const CellStream stream = stream_of(evaluation_of(star(8, "<set parameter='r' value='0.1 + 0.01*j'/>")));
  for (const std::uint64_t cell : {0, 5}) EXPECT_NEAR(ball_of(shape_of(stream, cell), 0), star_ball(0.17, 45), 1e-12);
}

TEST(Conformal, BeamsThatRunTogetherIntoAPoleAreTold) {
  // Of two cells along the radius each has a beam outwards along the axis, from the same pole: one is longer.
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='rho' count='1' start='9' spacing='2'/><loop index='j' "
                                     "axis='phi' count='6' spacing='60deg'/><loop index='k' axis='psi' count='1' "
                                     "start='-90deg' spacing='30deg'/><set parameter='x' value='0.5 + 0.1*j'/>",
                                     "<parameter id='x' value='1'/><box dx='1' dy='1' dz='1'/><beams radius='0.1' "
                                     "nodeRadius='auto'><node id='a' x='0' y='0.5' z='0'/><node id='b' x='x' y='0.5' "
                                     "z='0'/><beam from='a' to='b'/></beams>",
                                     "mapping='conformal' coordinateSystem='ball'", ball_system)),
              ElementsAre("BODY_DEGENERATE in cell (0, 0, 0) of pattern 'p'"));
}

TEST(Conformal, OtherBodiesAreRefused) {
  EXPECT_THAT(faults_of(pattern_text(sectors, "<box dx='1' dy='1' dz='1'/><csg><sphere radius='1'/></csg>",
                                     "mapping='conformal' coordinateSystem='polar'", polar)),
              ElementsAre("CONFORMAL_NOT_REALISED in cell (0, 0, 0) of pattern 'p'"));
}

}  // namespace
}  // namespace meso::eval
