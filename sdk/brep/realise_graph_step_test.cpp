// SPDX-License-Identifier: Apache-2.0
// Struts that differ and meet beyond the balls of their nodes, against bodies. Truths: what a point is in by
// definition, and that what a body leaves of a lattice and what the lattice leaves of it add up.
#include <algorithm>
#include <cmath>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using GraphStepTest = RealiseTest;

struct Strut {
  Vec3 from, to;
  double radius_from, radius_to;
};

/// Struts from the middles of 2 x 2 x 1 cells of 4 mm to four of their corners.
constexpr double edge = 4;
const std::vector<Vec3> corners{{0, 0, 0}, {4, 4, 0}, {4, 0, 4}, {0, 4, 4}};

std::vector<Strut> struts(double (*radius)(Vec3 p, int cell)) {
  std::vector<Strut> out;
  for (int i = 0; i < 4; ++i) {
    const Vec3 first{edge * (i % 2), edge * (i / 2), 0}, middle = first + Vec3{2, 2, 2};
    for (const Vec3 corner : corners)
      out.push_back({middle, first + corner, radius(middle, i % 2), radius(first + corner, i % 2)});
  }
  return out;
}

/// With round ends: those of all struts of a node.
bool holds(const std::vector<Strut>& struts, Vec3 p) {
  return std::ranges::any_of(struts, [&](const Strut& s) {
    const Vec3 way = s.to - s.from;
    const double t = dot(p - s.from, way) / dot(way, way);
    if (norm(p - s.from) <= s.radius_from || norm(p - s.to) <= s.radius_to) return true;
    return t >= 0 && t <= 1 && norm(p - s.from - t * way) <= s.radius_from + t * (s.radius_to - s.radius_from);
  });
}

std::string document(const std::string& set, const std::string& apply, const std::string& node_radius = "") {
  std::string nodes, beams;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto number = [](double x) { return std::to_string(static_cast<int>(x)); };
    const std::string name = "n" + std::to_string(i);
    nodes += "<node id='" + name + "' x='" + number(corners[i].x) + "' y='" + number(corners[i].y) + "' z='" +
             number(corners[i].z) + "'/>";
    beams += "<beam from='c' to='" + name + "'/>";
  }
  return "<unitCells><unitCell id='u'><parameter id='r' value='0.3'/><box dx='4' dy='4' dz='4'/><beams radius='r'" +
         node_radius + "><node id='c' x='2' y='2' z='2'/>" + nodes + beams +
         "</beams></unitCell></unitCells><patterns><pattern id='c' unitCell='u'><loop index='i' axis='x' count='2' "
         "spacing='4'/><loop index='j' axis='y' count='2' spacing='4'/>" +
         set + "</pattern></patterns>" + part(apply);
}
const std::string at_nodes = "<set parameter='r' value='0.3 + 0.02*global.x' at='node'/>",
                  by_cell = "<set parameter='r' value='0.3 + 0.1*i'/>",
                  cut_to = "<apply pattern='c' operation='intersection'/>";
double by_place(Vec3 p, int) { return 0.3 + 0.02 * p.x; }
double by_index(Vec3, int i) { return 0.3 + 0.1 * i; }

/// Of what is in both the struts and a body within a box, by points that are spread evenly and along no plane of the
/// lattice.
template <typename Body>
double volume_by_points(const std::vector<Strut>& struts, const Body& in_body, Vec3 low, Vec3 high) {
  constexpr int count = 300'000;
  constexpr double root = 1.2207440846057596;  // of x^4 = x + 1
  int within = 0;
  Vec3 share{0.5, 0.5, 0.5};
  for (int i = 0; i < count; ++i) {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) {
      share[a] = std::fmod(share[a] + 1 / std::pow(root, static_cast<double>(a) + 1), 1);
      p[a] = low[a] + share[a] * (high[a] - low[a]);
    }
    within += in_body(p) && holds(struts, p);
  }
  const Vec3 size = high - low;
  return within * size.x * size.y * size.z / count;
}

TEST_F(GraphStepTest, WhatABlockLeavesOfALattice) {
  for (const auto& [set, radius] : {std::pair{at_nodes, &by_place}, {by_cell, &by_index}}) {
    const auto made = realised(macrostructure("<box dx='8' dy='8' dz='4'/>") + document(set, cut_to));
    ASSERT_TRUE(made) << set;
    EXPECT_EQ(made->way, "boolean");
    EXPECT_TRUE(audit(made->body).clean());
    EXPECT_EQ(made->body.solids.size(), 2u);  // no corner is one of all four cells
    EXPECT_EQ(made->cells.kept, 4u);
    EXPECT_EQ(made->cells.crossing, 4u);
    const double truth = volume_by_points(struts(radius), [](Vec3) { return true; }, {0, 0, 0}, {8, 8, 4});
    EXPECT_NEAR(measure(made->body).volume, truth, 5e-3 * truth) << set;
  }
}

TEST_F(GraphStepTest, WhatACylinderLeavesOfALattice) {
  const auto made = realised(macrostructure("<cylinder x1='4' y1='4' z1='0.7' x2='4' y2='4' z2='3.3' radius='3.5'/>") +
                             document(at_nodes, cut_to));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "boolean");
  EXPECT_TRUE(audit(made->body).clean());
  const auto in_cylinder = [](Vec3 p) { return std::hypot(p.x - 4, p.y - 4) <= 3.5; };
  const double truth = volume_by_points(struts(by_place), in_cylinder, {0.5, 0.5, 0.7}, {7.5, 7.5, 3.3});
  EXPECT_NEAR(measure(made->body).volume, truth, 5e-3 * truth);
}

TEST_F(GraphStepTest, CellsThatThinAndSmallBodiesCrossAreCounted) {
  const std::string plate = macrostructure("<box x='1.3' dx='0.05' dy='8' dz='4'/>"),
                    speck = macrostructure("<box x='1.2' y='1.2' z='1.2' dx='0.05' dy='0.05' dz='0.05'/>");
  const auto cut = realised(plate + document(at_nodes, "<apply pattern='c' operation='difference'/>"));
  ASSERT_TRUE(cut);
  EXPECT_LT(measure(cut->body).volume, 0.05 * 8 * 4);
  EXPECT_EQ(cut->cells.kept, 2u);
  EXPECT_EQ(cut->cells.crossing, 2u);
  const auto within = realised(speck + document(at_nodes, cut_to));
  ASSERT_TRUE(within);
  EXPECT_NEAR(measure(within->body).volume, 0.05 * 0.05 * 0.05, 1e-9);
  EXPECT_EQ(within->cells.kept, 1u);
}

TEST_F(GraphStepTest, AUnionKeepsTheCellsThatThePatternHas) {
  const auto made = realised(macrostructure("<box dx='8' dy='8' dz='1'/>") +
                             document(at_nodes + "<when test='i == j'/>", "<apply pattern='c' operation='union'/>"));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->cells.kept, 2u);
}

// V(M n L) + V(M - L) = V(M); V(M u L) = V(M - L) + V(L), where L is put together without a boolean.
TEST_F(GraphStepTest, UnionAndDifferenceAddUp) {
  const std::string body = macrostructure("<box x='1' y='1' z='-1' dx='5' dy='6' dz='3.5'/>");
  const auto volume = [&](const std::string& operation) {
    const auto made = realised(
        body + document(at_nodes, "<apply pattern='c' operation='" + operation + "'/>", " nodeRadius='1.2*r'"));
    EXPECT_TRUE(made && audit(made->body).clean()) << operation;
    EXPECT_EQ(made ? made->way : "", "boolean");
    return made ? measure(made->body).volume : 0;
  };
  std::string alone = document(at_nodes, "<apply pattern='c' operation='union'/>", " nodeRadius='1.2*r'");
  alone.erase(alone.find(" macrostructure"), std::string(" macrostructure=\"m\"").size());
  const auto lattice = realised(alone);
  ASSERT_TRUE(lattice);
  EXPECT_EQ(lattice->way, "beamGraph");
  const double cut = volume("difference");
  EXPECT_NEAR((volume("intersection") + cut) / (5 * 6 * 3.5), 1, 1e-6);
  EXPECT_NEAR(volume("union") / (cut + measure(lattice->body).volume), 1, 1e-6);
}

TEST_F(GraphStepTest, LooseFragmentsAreCountedAndLeftOut) {
  // The slab leaves pieces of four struts.
  const std::string body = macrostructure("<box x='-1' y='-1' z='2.5' dx='10' dy='10' dz='1'/>");
  const auto made = realised(body + document(by_cell, cut_to));
  ASSERT_TRUE(made);
  EXPECT_GT(made->body.solids.size(), 1u);
  EXPECT_EQ(made->cells.fragments, made->body.solids.size() - 1);
  const auto largest =
      realised(body + document(by_cell, "<apply pattern='c' operation='intersection' fragments='drop'/>"));
  ASSERT_TRUE(largest);
  EXPECT_EQ(largest->body.solids.size(), 1u);
  EXPECT_EQ(largest->cells.dropped, made->cells.fragments);
}

TEST_F(GraphStepTest, ABentTrussThatABodyCuts) {
  const std::string system =
      "<coordinateSystems><coordinateSystem id='polar'><axis name='rho' kind='distance' x='1'/><axis name='phi' "
      "kind='circular' z='1'/><axis name='h' kind='linear' z='1'/></coordinateSystem></coordinateSystems>";
  const auto bent = [&](const std::string& operation, bool with_body) {
    std::string text = document("", "<apply pattern='c' operation='" + operation + "'/>");
    const std::size_t from = text.find("<pattern id='c'"), to = text.find("</pattern>");
    text.replace(from, to - from,
                 "<pattern id='c' unitCell='u' coordinateSystem='polar' mapping='conformal'><loop index='i' axis='rho' "
                 "count='1' start='8' spacing='4'/><loop index='j' axis='phi' count='3' spacing='20deg'/><loop "
                 "index='k' axis='h' count='1' spacing='4'/>");
    if (!with_body) text.erase(text.find(" macrostructure"), std::string(" macrostructure=\"m\"").size());
    return system + text;
  };
  const auto free = realised(bent("union", false));
  ASSERT_TRUE(free);
  EXPECT_EQ(free->way, "beamGraph");
  double sum = 0;
  for (const char* z : {"-5", "1.3"}) {
    const auto half = realised(macrostructure("<box y='-5' z='" + std::string(z) + "' dx='20' dy='30' dz='" +
                                              (z[0] == '-' ? "6.3" : "10") + "'/>") +
                               bent("intersection", true));
    ASSERT_TRUE(half) << z;
    EXPECT_EQ(half->way, "boolean");
    EXPECT_TRUE(audit(half->body).clean());
    sum += measure(half->body).volume;
  }
  EXPECT_NEAR(sum / measure(free->body).volume, 1, 1e-6);
}

TEST_F(GraphStepTest, StrutsThatDoNotRunFreeAreTold) {
  std::string nine = document("<set parameter='r' value='1.5' at='node'/>", cut_to, " nodeRadius='auto'");
  nine.replace(nine.find("count='2'"), 9, "count='5'");
  EXPECT_FALSE(realised(macrostructure("<box dx='20' dy='8' dz='4'/>") + nine));
  EXPECT_EQ(first_code(), Code::geometry_struts_thick);
  EXPECT_NE(render(sink_.diagnostics().front()).find("radius 1.5 mm"), std::string::npos);
}

TEST_F(GraphStepTest, StrutsThatCrossAreToldAtOnce) {
  // A strut from corner to corner passes the middle of one from middle to middle of the neighbouring cells.
  std::string crossing = document(at_nodes, cut_to);
  crossing.replace(crossing.find("</beams>"), 8, "<beam from='n0' to='n2'/><beam from='n1' to='n3'/></beams>");
  crossing.replace(crossing.find("spacing='4'"), 11, "spacing='2'");
  crossing.replace(crossing.find("count='2'"), 9, "count='5'");
  EXPECT_FALSE(realised(macrostructure("<box dx='12' dy='8' dz='4'/>") + crossing));
  EXPECT_EQ(sink_.diagnostics().back().code, Code::brep_not_realised);
}

}  // namespace
}  // namespace meso::brep
