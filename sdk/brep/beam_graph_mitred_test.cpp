// SPDX-License-Identifier: Apache-2.0
// Struts that meet each other beyond the balls of their nodes. Truths: closed forms, and what a point is in by
// definition.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "beam_graph_ball_faces.hpp"
#include "beam_graph_mitre_mesh.hpp"
#include "beam_graph_spans.hpp"
#include "meso/brep/gaps.hpp"
#include "realise_fixture.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

using MitredBeamsTest = RealiseTest;

struct Ball {
  Vec3 centre;
  double radius;
};
struct Cone {
  Vec3 from, to;
  double radius_from, radius_to;
};
struct Beams {
  std::vector<Ball> balls;
  std::vector<Cone> cones;
};

std::string text_of(const Beams& beams) {
  std::string out = "<unitCells><unitCell id='u'><beams radius='1'>";
  const auto number = [](double x) { return std::to_string(x); };
  for (std::size_t i = 0; i < beams.balls.size(); ++i) {
    const Vec3 p = beams.balls[i].centre;
    out += "<node id='n" + std::to_string(i) + "' x='" + number(p.x) + "' y='" + number(p.y) + "' z='" + number(p.z) +
           "' radius='" + number(beams.balls[i].radius) + "'/>";
  }
  const auto name = [&](Vec3 p) {
    for (std::size_t i = 0; i < beams.balls.size(); ++i)
      if (norm(beams.balls[i].centre - p) < 1e-9) return "n" + std::to_string(i);
    return std::string();
  };
  for (const Cone& c : beams.cones)
    out += "<beam from='" + name(c.from) + "' to='" + name(c.to) + "' radius1='" + number(c.radius_from) +
           "' radius2='" + number(c.radius_to) + "'/>";
  return out +
         "</beams></unitCell></unitCells><patterns><pattern id='a' unitCell='u'><loop index='i' axis='x' count='1' "
         "spacing='1'/></pattern></patterns>" +
         part("<apply pattern='a' operation='union'/>", false);
}

/// Struts from the origin to round ends, and a ball there.
Beams star(double ball, const std::vector<Cone>& cones) {
  Beams out{{{{}, ball}}, cones};
  for (const Cone& c : cones) out.balls.push_back({c.to, c.radius_to});
  return out;
}

bool holds(const Beams& beams, Vec3 p) {
  for (const Ball& b : beams.balls)
    if (norm(p - b.centre) <= b.radius) return true;
  for (const Cone& c : beams.cones) {
    const Vec3 way = c.to - c.from;
    const double t = dot(p - c.from, way) / dot(way, way);
    if (t < 0 || t > 1) continue;
    if (norm(p - c.from - t * way) <= c.radius_from + t * (c.radius_to - c.radius_from)) return true;
  }
  return false;
}

/// By points in a box, to 4 standard deviations; and by triangles.
void expect_as_defined(const std::optional<Realisation>& made, const Beams& beams, Vec3 low, Vec3 high) {
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, "beamGraph");
  EXPECT_TRUE(audit(made->body).clean());
  constexpr int count = 200000;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  int within = 0;
  for (int i = 0; i < count; ++i) {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = low[k] + share(random) * (high[k] - low[k]);
    within += holds(beams, p) ? 1 : 0;
  }
  const Vec3 size = high - low;
  const double box = size.x * size.y * size.z, part = static_cast<double>(within) / count;
  EXPECT_NEAR(measure(made->body).volume, box * part, 4 * box * std::sqrt(part * (1 - part) / count));
  EXPECT_NEAR(volume_of_triangles(made->body) / measure(made->body).volume, 1, 0.005);
}

const RealiseOptions meshed{.mesh = true, .deflection_mm = 0.002, .angle_rad = 0.1};

TEST_F(MitredBeamsTest, AKneeIsTwoCutCylindersAndASectorOfABall) {
  constexpr double r = 0.5, length = 4, angle = 2 * pi / 3;
  const Vec3 first{length, 0, 0}, second{-2, 3.4641016, 0};
  const auto made = realised(text_of(star(r, {{{}, first, r, r}, {{}, second, r, r}})), meshed);
  const double hoof = 2.0 / 3 * r * r * r / std::tan(angle / 2);  // that the bisecting plane takes of each cylinder
  const double sector = 2.0 / 3 * (pi - angle) * r * r * r, ends = 4.0 / 3 * pi * r * r * r;
  expect_body(made, "beamGraph", pi * r * r * (norm(first) + norm(second)) - 2 * hoof + sector + ends);
  EXPECT_EQ(measure(made->body).faces, 5u);
  EXPECT_NEAR(volume_of_triangles(made->body) / measure(made->body).volume, 1, 0.005);
}

TEST_F(MitredBeamsTest, SixStrutsAcrossAreSteinmetzBodies) {
  constexpr double r = 0.5, length = 3;
  std::vector<Cone> cones;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double way : {length, -length}) {
      Vec3 to;
      to[axis] = way;
      cones.push_back({{}, to, r, r});
    }
  const auto made = realised(text_of(star(r, cones)), meshed);
  const double cubed = r * r * r, two = 16.0 / 3 * cubed, three = 8 * (2 - std::sqrt(2.0)) * cubed;
  expect_body(made, "beamGraph", 6 * pi * r * r * length - 3 * two + three + 6 * 2.0 / 3 * pi * cubed);
  EXPECT_EQ(measure(made->body).faces, 12u);  // struts and round ends, nothing of the ball
  EXPECT_NEAR(volume_of_triangles(made->body) / measure(made->body).volume, 1, 0.005);
}

TEST_F(MitredBeamsTest, CornersOfFourStrutsInAPlaneAreOnePoint) {
  constexpr double r = 0.4, length = 3;
  const auto made = realised(text_of(star(r, {{{}, {length, 0, 0}, r, r},
                                              {{}, {-length, 0, 0}, r, r},
                                              {{}, {0, length, 0}, r, r},
                                              {{}, {0, -length, 0}, r, r}})),
                             meshed);
  const double cubed = r * r * r;
  expect_body(made, "beamGraph", 4 * pi * r * r * length - 16.0 / 3 * cubed + 4 * 2.0 / 3 * pi * cubed);
}

TEST_F(MitredBeamsTest, BallsSmallerThanAutomaticOnesKeepTheirShape) {
  const Beams beams = star(0.6, {{{}, {4, 0, 0}, 0.5, 0.5}, {{}, {0, 4, 0}, 0.5, 0.5}});
  expect_as_defined(realised(text_of(beams), meshed), beams, {-0.6, -0.6, -0.6}, {4.5, 4.5, 0.6});
}

TEST_F(MitredBeamsTest, StrutsOfDifferentRadiiMeetAsDefined) {
  const Beams beams =
      star(0.45, {{{}, {3, 0, 0}, 0.4, 0.4}, {{}, {2, 2, 0.5}, 0.3, 0.3}, {{}, {-1, 2, -1}, 0.45, 0.45}});
  expect_as_defined(realised(text_of(beams), meshed), beams, {-1.6, -0.6, -1.6}, {3.5, 2.6, 1});
}

TEST_F(MitredBeamsTest, StrutsThatGrowMeetAsDefined) {
  const Beams beams = star(0.3, {{{}, {3, 0, 0}, 0.3, 0.5}, {{}, {2, 2.5, 0}, 0.3, 0.2}, {{}, {0.5, 2, 2}, 0.3, 0.35}});
  expect_as_defined(realised(text_of(beams), meshed), beams, {-0.4, -0.6, -0.6}, {3.6, 2.8, 2.5});
}

// Of two struts as thick at their node, the one that grows is thicker at once: the other one is in sight between the
// ball and where it goes into the first, in a strip that comes to a tip.
TEST_F(MitredBeamsTest, AStripBetweenBallAndStrutIsSeenAsDefined) {
  const Beams beams = star(0.3, {{{}, {3, 0, 0}, 0.3, 1.2}, {{}, {0.5, 3, 0}, 0.3, 0.3}, {{}, {-1, -1, 2}, 0.3, 0.3}});
  expect_as_defined(realised(text_of(beams), meshed), beams, {-1.4, -1.4, -1.3}, {4.3, 3.4, 2.4});
}

TEST_F(MitredBeamsTest, ALoneStrutBesideOthersLeavesTheBallInACircle) {
  const Beams beams =
      star(0.6, {{{}, {3, 0, 0}, 0.5, 0.5}, {{}, {1.5, 2.5, 0}, 0.5, 0.5}, {{}, {-1, -1, 2}, 0.3, 0.3}});
  expect_as_defined(realised(text_of(beams), meshed), beams, {-1.4, -1.4, -0.7}, {3.6, 3.1, 2.4});
}

TEST_F(MitredBeamsTest, CurvesAreOnBothSurfacesForAnyReader) {
  const Beams beams = star(0.3, {{{}, {3, 0, 0}, 0.3, 0.5}, {{}, {2, 2.5, 0}, 0.3, 0.2}});
  const auto made = realised(text_of(beams));
  ASSERT_TRUE(made);
  const Gaps gaps = measure_gaps(made->body);
  EXPECT_LT(gaps.edge_mm, 1e-7);
  EXPECT_LT(gaps.vertex_mm, 1e-7);
}

/// From the surface of a strut that goes on.
double distance_from(const Cone& c, Vec3 p) {
  const Vec3 way = c.to - c.from, axis = way / norm(way);
  const double along = dot(p - c.from, axis), growth = (c.radius_to - c.radius_from) / norm(way);
  const double off = norm(p - c.from - along * axis) - c.radius_from - growth * along;
  return std::fabs(off) / std::hypot(1, growth);
}

TEST_F(MitredBeamsTest, CurvesStayOnBothSurfacesAllTheWay) {
  constexpr double ball = 0.3;
  const Beams beams =
      star(ball, {{{}, {3, 0, 0}, 0.3, 0.5}, {{}, {2, 2.5, 0}, 0.3, 0.2}, {{}, {-1, 2, 1.5}, 0.25, 0.3}});
  const auto made = realised(text_of(beams));
  ASSERT_TRUE(made);
  std::size_t curves = 0;
  for (const EdgeTemplate& edge : made->body.solids[0].outer.geometry->edges) {
    const auto* curve = std::get_if<BSplineCurve>(&edge.curve);
    if (curve == nullptr) continue;
    ++curves;
    EXPECT_LE(curve->poles.size(), 100u);  // as cubics they have hundreds
    const Handle(Geom_Curve) geometry = to_geom(edge.curve);
    const double first = curve->knots.front(), length = curve->knots.back() - first;
    for (int i = 0; i <= 1000; ++i) {
      const gp_Pnt p = geometry->Value(first + length * i / 1000);
      std::vector<double> distances;
      for (const Cone& c : beams.cones) distances.push_back(distance_from(c, {p.X(), p.Y(), p.Z()}));
      std::ranges::sort(distances);
      EXPECT_LT(distances[1], 4e-8 * ball) << i;
    }
  }
  EXPECT_GT(curves, 2u);
}

TEST(MitreSpans, APolynomialOfDegreeSevenIsItself) {
  const auto curve = [](double t) { return Vec3{std::pow(t, 7) - t, 2 * std::pow(t, 5), 1 - std::pow(t, 6)}; };
  const auto slope = [](double t) { return Vec3{7 * std::pow(t, 6) - 1, 10 * std::pow(t, 4), -6 * std::pow(t, 5)}; };
  std::array<Vec3, 4> points, tangents;
  for (std::size_t k = 0; k < 4; ++k) {
    points[k] = curve(span_places[k]);
    tangents[k] = slope(span_places[k]);
  }
  const SpanPoles poles = span_poles(points, tangents);
  for (int i = 0; i <= 10; ++i) EXPECT_NEAR(norm(point_of(poles, i / 10.0) - curve(i / 10.0)), 0, 1e-13);
}

TEST(MitreMesh, ABorderThatTurnsBackIsFilledWithoutFolds) {
  const MitredStrut strut{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1, 0, 1, 3};
  const auto on = [](double turn, double height) { return Vec3{std::cos(turn), std::sin(turn), height}; };
  std::array<std::vector<Vec3>, 2> borders;
  // Up to a tip at 2, above itself back to 1, and on from there.
  for (const auto& [turn, height] : std::vector<std::array<double, 2>>{{0, 0},
                                                                       {0.5, 0},
                                                                       {1, 0},
                                                                       {1.5, 0},
                                                                       {2, 0},
                                                                       {1.5, 0.3},
                                                                       {1, 0.5},
                                                                       {1.5, 0.8},
                                                                       {2, 0.9},
                                                                       {3, 0.5},
                                                                       {4, 0.2},
                                                                       {5, 0}})
    borders[0].push_back(on(turn, height));
  for (int i = 0; i < 12; ++i) borders[1].push_back(on(2 * pi * i / 12, 4));
  const Triangulation mesh = mitred_mesh(strut, borders);
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]].point, b = mesh.points[t[1]].point, c = mesh.points[t[2]].point;
    const Vec3 middle = (a + b + c) / 3;
    EXPECT_GT(dot(cross(b - a, c - a), Vec3{middle.x, middle.y, 0}), 0);
  }
}

TEST(BallFaces, PolesAndSeamKeepOffALune) {
  UnitLoop lune;
  for (int i = 0; i < 20; ++i) lune.push_back({0, std::sin(pi * i / 20), -std::cos(pi * i / 20)});
  for (int i = 0; i < 20; ++i) {
    const double out = std::sin(pi * i / 20);
    lune.push_back({out * std::sin(0.4), out * std::cos(0.4), std::cos(pi * i / 20)});
  }
  const auto axes = axes_off({}, {lune});
  ASSERT_TRUE(axes);
  for (const Vec3& p : lune) {
    EXPECT_LT(std::fabs(dot(p, axes->z)), 0.95);
    EXPECT_FALSE(dot(p, axes->x) > 0 && std::fabs(dot(p, cross(axes->z, axes->x))) < 0.05);
  }
}

}  // namespace
}  // namespace meso::brep
