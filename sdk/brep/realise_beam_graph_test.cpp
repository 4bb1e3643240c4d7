// SPDX-License-Identifier: Apache-2.0
// Beams put together from whole balls, cylinders and cones. Truths: closed forms, the periodic engine, triangles.
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "meso/brep/triangles.hpp"
#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

class BeamGraphTest : public RealiseTest {
 protected:
  bool was_told(Code code) const {
    for (const Diagnostic& d : sink_.diagnostics())
      if (d.code == code) return true;
    return false;
  }
};

std::string cell(const std::string& inside) {
  return "<unitCells><unitCell id='u'>" + inside + "</unitCell></unitCells>";
}
std::string union_of(const std::string& generator, const std::string& attributes = "") {
  return "<patterns><pattern id='a' unitCell='u' " + attributes + ">" + generator + "</pattern></patterns>" +
         part("<apply pattern='a' operation='union'/>", false);
}
const std::string once = "<loop index='i' axis='x' count='1' spacing='1'/>";

std::string node(const std::string& id, const std::string& x, const std::string& y, const std::string& z) {
  return "<node id='" + id + "' x='" + x + "' y='" + y + "' z='" + z + "'/>";
}
std::string beam(const std::string& from, const std::string& to) {
  return "<beam from='" + from + "' to='" + to + "'/>";
}

/// Corners to the centre of a box of edge 5.
std::string bcc(const std::string& radius, const std::string& ball) {
  std::string nodes = node("c", "2.5", "2.5", "2.5"), beams;
  for (int k = 0; k < 8; ++k) {
    const std::string id = "n" + std::to_string(k);
    nodes += node(id, k & 1 ? "5" : "0", k & 2 ? "5" : "0", k & 4 ? "5" : "0");
    beams += beam(id, "c");
  }
  return cell("<parameter id='r' value='" + radius + "'/><box dx='5' dy='5' dz='5'/><beams radius='r' nodeRadius='" +
              ball + "'>" + nodes + beams + "</beams>");
}
std::string block(int n, const std::string& set) {
  std::string loops;
  for (const char* axis : {"x", "y", "z"})
    loops += std::string("<loop index='") + axis[0] + "i' axis='" + axis + "' count='" + std::to_string(n) +
             "' spacing='5'/>";
  return union_of(loops + set);
}

/// Every side of a triangle is a side of one other, bit for bit, the other way round.
bool is_watertight(const Body& body) {
  using Point = std::tuple<float, float, float>;
  std::map<std::pair<Point, Point>, int> sides;
  const auto rounded = [](Vec3 p) {
    return Point(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
  };
  visit_triangles(body, [&](std::span<const Triangle> triangles) {
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Point a = rounded(t[k]), b = rounded(t[(k + 1) % 3]);
        if (a < b) ++sides[{a, b}];
        if (b < a) --sides[{b, a}];
      }
  });
  for (const auto& [side, sum] : sides)
    if (sum != 0) return false;
  return !sides.empty();
}

double volume_of_triangles(const Body& body) {
  double sum = 0;
  visit_triangles(body, [&](std::span<const Triangle> triangles) {
    for (const Triangle& t : triangles) sum += dot(t[0], cross(t[1], t[2])) / 6;
  });
  return sum;
}

void expect_triangles(const Body& body, double within) {
  EXPECT_TRUE(is_watertight(body));
  EXPECT_NEAR(volume_of_triangles(body) / measure(body).volume, 1, within);
}

TEST_F(BeamGraphTest, AStrutWithRoundEndsIsACapsule) {
  const auto made = realised(cell("<beams radius='0.5' nodeRadius='auto'>" + node("a", "0", "0", "0") +
                                  node("b", "1", "2", "2") + beam("a", "b") + "</beams>") +
                                 union_of(once),
                             {.mesh = true, .deflection_mm = 0.001});
  expect_body(made, "beamGraph", pi * 0.25 * 3 + 4 * pi / 3 * 0.125);
  EXPECT_NEAR(measure(made->body).centroid.z, 1, 1e-12);
  EXPECT_NEAR(measure(made->body).area, 2 * pi * 0.5 * 3 + 4 * pi * 0.25, 1e-12);
  expect_triangles(made->body, 0.01);
}

TEST_F(BeamGraphTest, StrutsInARowShareACircleAndNoBall) {
  const auto made = realised(cell("<beams radius='0.5' nodeRadius='auto'>" + node("a", "0", "0", "0") +
                                  node("b", "3", "0", "0") + beam("a", "b") + "</beams>") +
                                 union_of("<loop index='i' axis='x' count='4' spacing='3'/>"),
                             {.mesh = true, .deflection_mm = 0.001});
  expect_body(made, "beamGraph", pi * 0.25 * 12 + 4 * pi / 3 * 0.125);
  EXPECT_EQ(measure(made->body).faces, 6u);  // four struts, two round ends
  expect_triangles(made->body, 0.01);
}

TEST_F(BeamGraphTest, SwallowedStrutsLeaveBallsThatMeet) {
  const auto lens = realised(cell("<parameter id='r' value='0.5'/><beams radius='r' nodeRadius='2'>" +
                                  node("a", "0", "0", "0") + node("b", "3", "0", "0") + beam("a", "b") + "</beams>") +
                                 union_of(once),
                             {.mesh = true, .deflection_mm = 0.001});
  const double cap = pi * 0.25 * (2 - 0.5 / 3);
  expect_body(lens, "beamGraph", 2 * (4 * pi / 3 * 8 - cap));
  expect_triangles(lens->body, 0.01);
}

TEST_F(BeamGraphTest, AConstantGradientIsThePeriodicLattice) {
  const std::string chain = cell(
      "<parameter id='r' value='0.5'/><box dx='5' dy='5' dz='5'/><beams radius='r' "
      "nodeRadius='0.9'>" +
      node("a", "0", "2.5", "2.5") + node("b", "5", "2.5", "2.5") + beam("a", "b") + "</beams>");
  const std::string loop = "<loop index='i' axis='x' count='4' spacing='5'/>";
  const auto graph = realised(chain + union_of(loop + "<set parameter='r' value='0.5 + 0*i'/>"));
  const auto lattice = realised(chain + union_of(loop));
  ASSERT_TRUE(graph && lattice);
  EXPECT_EQ(graph->way, "beamGraph");
  EXPECT_EQ(lattice->way, "lattice");
  const Measures a = measure(graph->body), b = measure(lattice->body);
  EXPECT_NEAR(a.volume / b.volume, 1, 1e-9);
  EXPECT_NEAR(a.area / b.area, 1, 1e-9);
  EXPECT_NEAR(norm(a.centroid - b.centroid), 0, 1e-7);
  EXPECT_TRUE(audit(graph->body).clean());
}

TEST_F(BeamGraphTest, AutomaticBallsTouchInPointsAndAreDividedThere) {
  const auto made = realised(bcc("0.5", "auto") + block(2, ""), {.mesh = true, .deflection_mm = 0.01});
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "beamGraph");
  EXPECT_TRUE(audit(made->body).clean());
  EXPECT_NEAR(measure(made->body).volume / made->body.pieces_volume, 1, 1e-12);
  // 64 struts, a face at each of 8 corners, six faces at each of the 8 middle nodes and the inner one. Where four
  // struts meet or two, the half of the ball that is away from them is divided in one way or another.
  EXPECT_GE(measure(made->body).faces, 64u + 8 + 9 * 6 + 6 * 2 + 12);
  EXPECT_LE(measure(made->body).faces, 64u + 8 + 9 * 6 + 6 * 6 + 12 * 6);
  for (const FaceTemplate& face : made->body.solids[0].outer.geometry->faces) {
    EXPECT_EQ(face.loops.size(), 1u);
    if (!std::holds_alternative<SphereSurface>(face.surface) || face.loops[0].size() == 4) continue;
    std::set<std::uint32_t> passed;  // vertices: no border touches itself
    for (const Coedge& use : face.loops[0])
      EXPECT_TRUE(
          passed.insert(made->body.solids[0].outer.geometry->edges[use.edge].vertex[use.reversed ? 1 : 0]).second);
  }
  expect_triangles(made->body, 0.05);
}

TEST_F(BeamGraphTest, GradedLatticesCloseWhateverTheGradient) {
  for (const std::string set :
       {"value='0.3 + 0.05*xi + 0.02*yi*zi'", "value='0.3 + 0.01*global.x + 0.02*global.z' at='node'",
        "value='0.4 + 0.1*sin(global.x + 2*global.y)' at='node'"}) {
    const auto made = realised(bcc("0.5", "auto") + block(3, "<set parameter='r' " + set + "/>"),
                               {.mesh = true, .deflection_mm = 0.01});
    ASSERT_TRUE(made) << set;
    EXPECT_EQ(made->way, "beamGraph");
    EXPECT_EQ(made->body.solids.size(), 1u);
    EXPECT_TRUE(audit(made->body).clean());
    EXPECT_NEAR(measure(made->body).volume / made->body.pieces_volume, 1, 1e-12);
    expect_triangles(made->body, 0.05);
  }
}

TEST_F(BeamGraphTest, RadiiThatNearlyPartStrutsAreSnappedAndTold) {
  const std::string corner = node("a", "0", "0", "0") + "<node id='b' x='4' y='0' z='0' radius='0.5'/>" +
                             "<node id='c' x='0' y='4' z='0' radius='0.5'/>" + beam("a", "b") + beam("a", "c") +
                             "</beams>";
  const double exact = 0.5 * std::sqrt(2.0);
  const auto nearly = realised(
      cell("<beams radius='0.5' nodeRadius='" + std::to_string(exact * (1 - 1e-5)) + "'>" + corner) + union_of(once));
  ASSERT_TRUE(nearly);
  EXPECT_EQ(nearly->way, "beamGraph");
  EXPECT_TRUE(was_told(Code::geometry_radii_snapped));
  const auto precise = realised(cell("<beams radius='0.5' nodeRadius='auto'>" + corner) + union_of(once));
  ASSERT_TRUE(precise);
  EXPECT_FALSE(was_told(Code::geometry_radii_snapped));
  EXPECT_NEAR(measure(nearly->body).volume / measure(precise->body).volume, 1, 1e-4);
}

TEST_F(BeamGraphTest, BallsOfDifferentStrutsMayMeet) {
  // Two struts side by side; the balls at their ends pass into each other, two by two.
  const auto ball = [](const std::string& id, const std::string& x, const std::string& y) {
    return "<node id='" + id + "' x='" + x + "' y='" + y + "' z='0' radius='0.9'/>";
  };
  const auto made =
      realised(cell("<beams radius='0.5' nodeRadius='auto'>" + ball("a", "0", "0") + ball("b", "5", "0") +
                    ball("c", "0", "1.5") + ball("d", "5", "1.5") + beam("a", "b") + beam("c", "d") + "</beams>") +
               union_of(once));
  const double s = std::sqrt(0.81 - 0.25), cap = pi * (0.9 - s) * (0.9 - s) * (1.8 + s) / 3,
               lens = 2 * pi * 0.15 * 0.15 * (2.7 - 0.15) / 3;
  expect_body(made, "beamGraph", 2 * (2 * (4 * pi / 3 * 0.729 - cap) + pi * 0.25 * (5 - 2 * s)) - 2 * lens);
  EXPECT_EQ(made->body.solids.size(), 1u);
}

TEST_F(BeamGraphTest, StrutsThatCrossAwayFromNodesAreNotAGraph) {
  const auto made = realised(cell("<beams radius='0.5' nodeRadius='auto'>" + node("a", "0", "0", "0") +
                                  node("b", "4", "4", "0") + node("c", "0", "4", "0") + node("d", "4", "0", "0") +
                                  beam("a", "b") + beam("c", "d") + "</beams>") +
                             union_of(once));
  EXPECT_TRUE(was_told(Code::geometry_struts_meet));
  EXPECT_TRUE(!made || made->way != "beamGraph");
}

std::string tube(const std::string& ball, const std::string& inner_radius = "15") {
  return "<coordinateSystems><coordinateSystem id='polar'><axis name='rho' kind='distance' x='1'/><axis name='phi' "
         "kind='circular' z='1'/><axis name='h' kind='linear' z='1'/></coordinateSystem></coordinateSystems>" +
         bcc("0.4", ball) +
         union_of("<loop index='i' axis='rho' count='2' start='" + inner_radius +
                      "' spacing='4'/>"
                      "<loop index='j' axis='phi' count='24' spacing='15deg'/>"
                      "<loop index='k' axis='h' count='2' spacing='4'/>",
                  "coordinateSystem='polar' mapping='conformal'");
}

TEST_F(BeamGraphTest, ATrussBendsIntoATube) {
  const auto made = realised(tube("auto"), {.mesh = true, .deflection_mm = 0.02});
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "beamGraph");
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_TRUE(audit(made->body).clean());
  EXPECT_NEAR(measure(made->body).volume / made->body.pieces_volume, 1, 1e-12);
  EXPECT_NEAR(norm(measure(made->body).centroid - Vec3{0, 0, 4}), 0, 1e-9);
  expect_triangles(made->body, 0.05);
}

TEST_F(BeamGraphTest, StrutsThatDoNotPartBeforeTheirEndsAreRefusedAtOnce) {
  EXPECT_FALSE(realised(tube("auto", "0")));  // 24 cells meet in the axis
  EXPECT_EQ(sink_.diagnostics().back().code, Code::geometry_struts_thick);
  EXPECT_NE(render(sink_.diagnostics().back()).find("degrees apart"), std::string::npos);
}

/// Sectors around the axis, from pole to pole or short of them; `bcc` in fractions of the sectors.
std::string sphere(const std::string& cells, double from_deg, int rings, int sectors = 6) {
  return "<coordinateSystems><coordinateSystem id='ball'><axis name='rho' kind='distance' x='1'/><axis name='phi' "
         "kind='circular' z='1'/><axis name='psi' kind='circular' y='-1'/></coordinateSystem></coordinateSystems>" +
         cells +
         union_of(
             "<loop index='i' axis='rho' count='1' start='10' spacing='4'/>"
             "<loop index='j' axis='phi' count='" +
                 std::to_string(sectors) + "' spacing='360deg/" + std::to_string(sectors) +
                 "'/><loop index='k' axis='psi' count='" + std::to_string(rings) + "' start='" +
                 std::to_string(from_deg) + "deg' spacing='30deg'/>",
             "coordinateSystem='ball' mapping='conformal'");
}

TEST_F(BeamGraphTest, ATrussBendsIntoABallPolesIncluded) {
  // Nodes: two spheres of 2 poles and 5 rings of 6, and 36 centres. A centre has 8 beams, 6 where 2 end in a pole
  // twice.
  const auto made = realised(sphere(bcc("0.15", "auto"), -90, 6), {.mesh = true, .deflection_mm = 0.01});
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "beamGraph");
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_TRUE(audit(made->body).clean());
  EXPECT_NEAR(measure(made->body).volume / made->body.pieces_volume, 1, 1e-9);
  EXPECT_NEAR(norm(measure(made->body).centroid), 0, 1e-9);
  std::size_t struts = 0;
  for (const FaceTemplate& face : made->body.solids[0].outer.geometry->faces)
    struts += std::holds_alternative<CylinderSurface>(face.surface) ? 1 : 0;
  EXPECT_EQ(struts, 24u * 8 + 12u * 6);
  expect_triangles(made->body, 0.05);
}

/// Its middle to the middles of its sides.
std::string cross(const std::string& radius) {
  std::string nodes = node("c", "2.5", "2.5", "2.5"), beams;
  const std::array<std::string, 2> sides{"0", "5"};
  for (const std::string& side : sides) {
    nodes += node("x" + side, side, "2.5", "2.5") + node("y" + side, "2.5", side, "2.5") +
             node("z" + side, "2.5", "2.5", side);
    for (const char* axis : {"x", "y", "z"}) beams += beam("c", axis + side);
  }
  return cell("<box dx='5' dy='5' dz='5'/><beams radius='" + radius + "' nodeRadius='auto'>" + nodes + beams +
              "</beams>");
}

TEST_F(BeamGraphTest, StrutsOfAllCellsAroundAPoleMakeItsBall) {
  // Rings of nodes at the middles of sectors and a node on each pole, where as many struts meet as there are sectors.
  for (const int sectors : {5, 9, 16}) {
    const auto made = realised(sphere(cross("0.1"), -90, 6, sectors), {.mesh = true, .deflection_mm = 0.01});
    ASSERT_TRUE(made) << sectors;
    EXPECT_EQ(made->way, "beamGraph");
    EXPECT_EQ(made->body.solids.size(), 1u);
    EXPECT_TRUE(audit(made->body).clean());
    EXPECT_NEAR(measure(made->body).volume / made->body.pieces_volume, 1, 1e-9);
    EXPECT_NEAR(norm(measure(made->body).centroid), 0, 1e-9);
    // The pole is at 12 mm, half way through a cell of 4 mm from 10 mm; its first ring 15 degrees above it.
    const double ball = 0.1 / (std::cos(pi / 24) * std::sin(pi / sectors));
    std::size_t found = 0;
    for (const FaceTemplate& face : made->body.solids[0].outer.geometry->faces)
      if (const auto* s = std::get_if<SphereSurface>(&face.surface))
        found += std::fabs(std::fabs(s->frame.origin.z) - 12) < 1e-9 && std::fabs(s->radius - ball) < 1e-9 ? 1 : 0;
    EXPECT_GE(found, 2u);
  }
}

TEST_F(BeamGraphTest, BeamsWithoutLengthOrAngleAreTold) {
  // A beam along the azimuth has no length on a pole.
  const std::string ring = cell("<box dx='1' dy='1' dz='1'/><beams radius='0.2'>" + node("a", "0", "0", "0") +
                                node("b", "0", "1", "0") + beam("a", "b") + "</beams>");
  EXPECT_FALSE(realised(sphere(ring, -90, 1)));
  EXPECT_EQ(first_code(), Code::body_degenerate);
  EXPECT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_TRUE(realised(sphere(ring, -60, 1)));
  // Two beams on top of each other.
  EXPECT_FALSE(
      realised(cell("<beams radius='0.2' nodeRadius='auto'>" + node("a", "0", "0", "0") + node("b", "2", "2", "2") +
                    node("c", "4", "4", "4") + beam("a", "b") + beam("a", "c") + "</beams>") +
               union_of(once)));
  EXPECT_EQ(first_code(), Code::body_degenerate);
  EXPECT_EQ(sink_.diagnostics().size(), 1u);
}

TEST_F(BeamGraphTest, StrutsAsThickAsTheirCellsAreRefusedAtOnce) {
  for (const char* ball : {"auto", "0"}) {
    EXPECT_FALSE(realised(bcc("4", ball) + block(2, "")));
    EXPECT_EQ(first_code(), Code::geometry_struts_thick);
    EXPECT_EQ(sink_.diagnostics().size(), 1u);
    EXPECT_FALSE(realised(macrostructure("<box dx='10' dy='10' dz='10'/>") + bcc("4", ball) +
                          block(2, "").substr(0, block(2, "").find("<parts>")) +
                          part("<apply pattern='a' operation='intersection'/>")));
    EXPECT_EQ(first_code(), Code::geometry_struts_thick);
  }
  // A single cell has no neighbours to meet, and a rod may be thicker than its cell is long.
  const std::string rod = node("a", "0", "5", "5") + node("b", "2", "5", "5") + beam("a", "b");
  const auto made =
      realised(cell("<box dx='2' dy='10' dz='10'/><beams radius='1.5' nodeRadius='auto'>" + rod + "</beams>") +
               union_of("<loop index='i' axis='x' count='3' spacing='2'/>"));
  expect_body(made, "lattice", pi * 2.25 * 6 + 4 * pi / 3 * 1.5 * 1.5 * 1.5);
}

TEST_F(BeamGraphTest, CellsThatMissTheBodyLeaveNothing) {
  for (const char* body :
       {"<box x='100' dx='2' dy='2' dz='2'/>", "<box x='2.4' y='0.1' z='0.1' dx='0.1' dy='0.1' dz='0.1'/>"}) {
    const std::string lattice = block(2, "");
    EXPECT_FALSE(realised(macrostructure(body) + bcc("0.2", "auto") + lattice.substr(0, lattice.find("<parts>")) +
                          part("<apply pattern='a' operation='intersection'/>")));
    EXPECT_EQ(sink_.diagnostics().back().code, Code::geometry_empty);
    EXPECT_EQ(sink_.error_count(), 1u);
  }
}

TEST_F(BeamGraphTest, TrianglesDoNotDependOnThreads) {
  const auto triangles = [&](unsigned jobs) {
    const auto made = realised(tube("auto"), {.mesh = true, .deflection_mm = 0.05, .run = {.jobs = jobs}});
    std::vector<Triangle> all;
    if (made)
      visit_triangles(made->body, [&](std::span<const Triangle> t) { all.insert(all.end(), t.begin(), t.end()); });
    return all;
  };
  const auto one = triangles(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, triangles(3));
}

}  // namespace
}  // namespace meso::brep
