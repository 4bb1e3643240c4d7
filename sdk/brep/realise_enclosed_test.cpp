// SPDX-License-Identifier: Apache-2.0
// Faceted bodies with copies of themselves inside. Which copies are inside is counted again without a tree, by solid
// angles and all pairs; volumes are V (1 - n s^3).
#include <filesystem>
#include <fstream>
#include <numbers>

#include "meso/base/triangle_stream.hpp"
#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;
using Triangles = std::vector<Triangle>;

/// A ball with bumps and dents, of a few hundred facets. Corners are multiples of 1/1024, which STL holds exactly.
Triangles bumpy() {
  constexpr int around = 20, up = 12;
  const auto at = [](int i, int k) {
    const double a = 2 * pi * (i % around) / around, b = pi * k / up;
    const double r = 10 * (1 + 0.2 * std::sin(3 * a) * std::sin(b) + 0.1 * std::cos(4 * b));
    Vec3 p{r * std::sin(b) * std::cos(a), r * std::sin(b) * std::sin(a), r * std::cos(b)};
    if (k == 0 || k == up) p.x = p.y = 0;
    for (std::size_t c = 0; c < 3; ++c) p[c] = std::round(p[c] * 1024) / 1024;
    return p;
  };
  Triangles out;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < up; ++k) {
      if (k > 0) out.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
      if (k + 1 < up) out.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
    }
  return out;
}

Triangles cube(double edge) {
  Triangles out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double level : {0.0, edge}) {
      std::array<Vec3, 4> p{};
      for (int i = 0; i < 4; ++i) {
        p[static_cast<std::size_t>(i)][axis] = level;
        p[static_cast<std::size_t>(i)][(axis + 1) % 3] = i == 1 || i == 2 ? edge : 0;
        p[static_cast<std::size_t>(i)][(axis + 2) % 3] = i >= 2 ? edge : 0;
      }
      if (level == 0) std::swap(p[1], p[3]);
      out.push_back({p[0], p[1], p[2]});
      out.push_back({p[0], p[2], p[3]});
    }
  return out;
}

double volume_of(const Triangles& triangles) {
  double volume = 0;
  for (const Triangle& t : triangles) volume += dot(t[0], cross(t[1], t[2])) / 6;
  return volume;
}

bool contains(const Triangles& triangles, Vec3 p) {
  double angle = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    angle += 2 * std::atan2(dot(a, cross(b, c)), norm(a) * norm(b) * norm(c) + dot(a, b) * norm(c) +
                                                     dot(b, c) * norm(a) + dot(c, a) * norm(b));
  }
  return angle > 2 * pi;
}

double distance(Vec3 p, const Triangle& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  bool is_above = true;
  double nearest = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = t[i], edge = t[(i + 1) % 3] - a;
    is_above = is_above && dot(cross(edge, p - a), normal) > 0;
    const double share = std::fmin(1, std::fmax(0, dot(p - a, edge) / dot(edge, edge)));
    nearest = std::fmin(nearest, norm(p - a - share * edge));
  }
  return is_above ? std::fabs(dot(p - t[0], normal)) / norm(normal) : nearest;
}

/// From corners and edge middles of the small one: 1 % too much at most.
double sampled_distance(const Triangles& body, const Triangles& copy) {
  constexpr double longest_edge = 6;
  double nearest = HUGE_VAL;
  for (const Triangle& t : body)
    for (const Triangle& s : copy) {
      if (norm(s[0] - t[0]) > longest_edge + 1) continue;
      for (std::size_t i = 0; i < 3; ++i)
        nearest = std::fmin(nearest, std::fmin(distance(s[i], t), distance((s[i] + s[(i + 1) % 3]) / 2, t)));
    }
  return nearest;
}

class Enclosed : public RealiseTest {
 protected:
  std::optional<Realisation> hollowed(const Triangles& body, const std::string& scale, const std::string& generator,
                                      const std::string& rule) {
    const std::string name =
        "enclosed_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".stl";
    std::ofstream file(name);
    file.precision(12);
    file << "solid body\n";
    for (const Triangle& t : body) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (const Vec3 p : t) file << "vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
      file << "endloop\nendfacet\n";
    }
    file << "endsolid\n";
    file.close();
    const std::string import = "<import href=\"" + name + "\" unit=\"millimeter\"";
    auto made = realised("<parameters><parameter id=\"s\" value=\"" + scale +
                         "\"/></parameters><macrostructures><macrostructure id=\"m\">" + import +
                         "/></macrostructure></macrostructures><unitCells><unitCell id=\"u\">" + import +
                         "><transform matrix=\"s,0,0,0, 0,s,0,0, 0,0,s,0\"/></import></unitCell></unitCells>"
                         "<patterns><pattern id=\"c\" unitCell=\"u\">" +
                         generator + "</pattern></patterns>" +
                         part("<apply pattern=\"c\" operation=\"difference\" " + rule + "/>"));
    std::filesystem::remove(name);
    return made;
  }
};

std::string grid(int count, double start, double spacing) {
  std::string out;
  for (const char* axis : {"x", "y", "z"})
    out += std::string("<loop index=\"n") + axis + "\" axis=\"" + axis + "\" count=\"" + std::to_string(count) +
           "\" start=\"" + std::to_string(start) + "\" spacing=\"" + std::to_string(spacing) + "\"/>";
  return out;
}
std::string at(std::initializer_list<Vec3> places) {
  std::string out = "<list>";
  for (const Vec3 p : places)
    out += "<place at=\"" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + "\"/>";
  return out + "</list>";
}

TEST_F(Enclosed, ABodyInsideItself) {
  const Triangles body = bumpy();
  const double scale = 0.125, clearance = 0.4;
  std::size_t inside = 0, crossing = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) {
        Triangles copy = body;
        for (Triangle& t : copy)
          for (Vec3& p : t) p = scale * p + Vec3{-8.1 + 3.3 * i, -8.1 + 3.3 * j, -8.1 + 3.3 * k};
        std::size_t corners = 0;
        for (const Triangle& t : copy) corners += contains(body, t[0]);
        if (corners > 0 && corners < copy.size()) ++crossing;
        if (corners == copy.size() && sampled_distance(body, copy) >= clearance) ++inside;
      }
  EXPECT_GT(crossing, 10u);
  ASSERT_GT(inside, 20u);
  const auto made = hollowed(body, "1/8", grid(6, -8.1, 3.3), R"(boundary="dropPartial" test="body" clearance="0.4")");
  const double n = static_cast<double>(inside);
  expect_body(made, "cells", volume_of(body) * (1 - n * std::pow(scale, 3)));
  EXPECT_EQ(made->cells.placed, 216u);
  EXPECT_EQ(made->cells.kept, inside);
  ASSERT_EQ(made->body.solids.size(), 1u);
  const Solid& solid = made->body.solids.front();
  ASSERT_EQ(solid.voids.size(), inside);
  for (const Shell& hollow : solid.voids) {
    EXPECT_EQ(hollow.geometry, solid.voids.front().geometry);  // one template, placed
    const Body alone{.solids = {{.outer = hollow, .voids = {}}}};
    EXPECT_NEAR(measure(alone).volume, -volume_of(body) * std::pow(scale, 3), 1e-9);
  }
}

TEST_F(Enclosed, ACopyThatCrossesIsDroppedWithoutABoolean) {
  const Triangles body = bumpy();
  for (const std::string rule : {R"(clearance="0.1")", ""}) {
    const auto made = hollowed(body, "0.1", at({{0, 0, 0}, {10.7, 0, 0}, {0, 11, 1}, {40, 0, 0}}),
                               R"(boundary="dropPartial" test="body" )" + rule);
    expect_body(made, "cells", volume_of(body) * (1 - 0.001));
    EXPECT_EQ(made->cells.kept, 1u);
  }
}

TEST_F(Enclosed, ClearanceIsMeasuredToAMillionth) {
  const auto kept = [&](const std::string& clearance) {
    const auto made = hollowed(cube(10), "0.1", at({{0.5, 3, 3}}),
                               R"(boundary="dropPartial" test="body" clearance=")" + clearance + "\"");
    return made ? made->cells.kept : 99;
  };
  EXPECT_EQ(kept("0.5"), 1u);
  EXPECT_EQ(kept("0.499"), 1u);
  EXPECT_EQ(kept("0.500003"), 0u);
  EXPECT_EQ(kept("0.6"), 0u);
}

TEST_F(Enclosed, FlushWithASideIsInside) {
  const std::string rule = R"(boundary="dropPartial" test="body")";
  const auto flush = hollowed(cube(10), "0.1", at({{0, 3, 3}}), rule);
  expect_body(flush, "boolean", 999);
  const auto out = hollowed(cube(10), "0.1", at({{-0.00001, 3, 3}, {5, 5, 5}}), rule);
  expect_body(out, "cells", 999);
  EXPECT_EQ(out->cells.kept, 1u);
}

TEST_F(Enclosed, CopiesThatOverlapAreOneHollow) {
  const std::string rule = R"(boundary="dropPartial" test="body" clearance="0.1")";
  const auto cubes = hollowed(cube(10), "0.1", at({{3, 3, 3}, {3.5, 3.5, 3.5}, {7, 7, 7}}), rule);
  expect_body(cubes, "boolean", 1000 - 3 + 0.125);
  EXPECT_EQ(cubes->body.solids.front().voids.size(), 2u);
  // One that is not taken does not join those that are.
  const auto apart = hollowed(cube(10), "0.1", at({{0.2, 3, 3}, {-0.7, 3, 3}}), rule);
  expect_body(apart, "cells", 999);
  const Triangles body = bumpy();
  const auto bumps = hollowed(body, "0.1", at({{0, 0, 0}, {1.1, 0.3, 0}}), rule);
  ASSERT_TRUE(bumps);
  EXPECT_TRUE(audit(bumps->body).clean());
  EXPECT_EQ(bumps->body.solids.front().voids.size(), 1u);
  const double volume = measure(bumps->body).volume, one = 0.001 * volume_of(body);
  EXPECT_LT(volume, volume_of(body) - one);
  EXPECT_GT(volume, volume_of(body) - 2 * one);
}

/// Pockets that lie side by side in one wall between cells are shells of their own.
TEST_F(Enclosed, PocketsInOneWallAreApart) {
  std::string pockets;
  for (const char* x : {"0", "4"})
    for (const char* yz : {"1", "3"})
      pockets += std::string("<sphere x='") + x + "' y='" + yz + "' z='" + yz + "' radius='0.5'/>";
  const auto made = realised(
      macrostructure("<box dx='12' dy='4' dz='4'/>") +
      "<unitCells><unitCell id='u'><box dx='4' dy='4' dz='4'/><csg><difference><box dx='4' dy='4' dz='4'/>" + pockets +
      "</difference></csg></unitCell></unitCells><patterns><pattern id='c' unitCell='u'><loop index='i' "
      "axis='x' count='3' spacing='4'/></pattern></patterns>" +
      part("<apply pattern='c' operation='intersection'/>"));
  expect_body(made, "lattice", 12 * 4 * 4 - 6 * 4 * std::numbers::pi / 3 * 0.125);
  ASSERT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(made->body.solids.front().voids.size(), 4u);
}

}  // namespace
}  // namespace meso::brep
