// SPDX-License-Identifier: Apache-2.0
// Every cell of the library as a block of 2 x 2 x 2 boxes: one repeated template, closed, and with the volume of
// docs/specification/library.md.
#include <cmath>
#include <numbers>

#include "meso/library/library.hpp"
#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

/// Struts of a length, and the radii of the balls at their ends, in units of the strut's radius.
struct Struts {
  double count, length, ball_from, ball_to;
};
struct Balls {
  double count, radius;
};

/// R-8.3, in one box with edges of 10 and struts of radius 0.5.
double strut_cell(const std::vector<Struts>& struts, const std::vector<Balls>& balls) {
  constexpr double a = 10, r = 0.5;
  double volume = 0;
  for (const Balls& b : balls) volume += b.count * 4 * pi / 3 * std::pow(b.radius * r, 3);
  for (const Struts& s : struts) {
    double one = pi * r * r * s.length * a;
    for (const double ball : {s.ball_from * r, s.ball_to * r}) {
      const double h = std::sqrt(ball * ball - r * r);
      one -= pi * r * r * h + pi * (ball - h) * (ball - h) * (2 * ball + h) / 3;
    }
    volume += s.count * one;
  }
  return volume;
}

double closed_form(std::string_view name) {
  const double s2 = std::sqrt(2.0), s3 = std::sqrt(3.0);
  if (name == "sc") return strut_cell({{3, 1, 1.6, 1.6}}, {{1, 1.6}});
  if (name == "bcc") return strut_cell({{8, s3 / 2, 1.8, 1.8}}, {{2, 1.8}});
  if (name == "fcc") return strut_cell({{12, 1 / s2, 2.1, 1.6}}, {{1, 2.1}, {3, 1.6}});
  if (name == "octet") return strut_cell({{24, 1 / s2, 2.1, 2.1}}, {{4, 2.1}});
  if (name == "kelvin") return strut_cell({{24, s2 / 4, 1.6, 1.6}}, {{12, 1.6}});
  if (name == "diamond") return strut_cell({{16, s3 / 4, 1.8, 1.8}}, {{8, 1.8}});
  if (name == "rhombicDodecahedron") return strut_cell({{32, s3 / 4, 1.4, 1.8}}, {{8, 1.4}, {4, 1.8}});
  if (name == "reentrant") {
    const double e = 0.2, lean = std::sqrt(0.5 + e * e), ball = 1.05 / std::sqrt((1 - e / lean) / 2);
    return strut_cell({{2, 0.5 + e, ball, ball}, {8, lean, ball, ball}}, {{4, ball}});
  }
  const double c = 5, w = 0.5, walls = 1 - std::pow(1 - w / (std::sqrt(3.0) * c), 2);  // honeycomb
  return walls * std::sqrt(3.0) * c * 3 * c * c;
}

class LibraryCells : public RealiseTest, public ::testing::WithParamInterface<std::string_view> {};

TEST_P(LibraryCells, BlockIsOneTemplateOfTheRightVolume) {
  const std::string name(GetParam());
  const bool is_honeycomb = name == "honeycomb";
  const std::string size_x = is_honeycomb ? "sqrt(3)*5" : "10", size_y = is_honeycomb ? "15" : "10",
                    size_z = is_honeycomb ? "5" : "10";
  const auto loop = [](const char* index, const char* axis, const std::string& size) {
    return std::string("<loop index=\"") + index + "\" axis=\"" + axis + "\" count=\"2\" spacing=\"" + size + "\"/>";
  };
  const auto made = realised(
      macrostructure("<box dx=\"2*" + size_x + "\" dy=\"2*" + size_y + "\" dz=\"2*" + size_z + "\"/>") +
      "<unitCells><unitCell id=\"u\" library=\"" + name +
      "\"/></unitCells><patterns><pattern id=\"c\" unitCell=\"u\">" + loop("i", "x", size_x) + loop("j", "y", size_y) +
      loop("k", "z", size_z) + "</pattern></patterns>" + part(R"(<apply pattern="c" operation="intersection"/>)"));
  ASSERT_TRUE(made);
  expect_body(made, "lattice", 8 * closed_form(name));
  EXPECT_EQ(made->cells.kept, 8u);
}

/// Radius at the node, and at the other end of a strut: what the strut adds to its two balls, of 1.8 radii.
double graded_strut(double from, double to, double length) {
  struct End {
    double along, radius, cap;
  };
  const auto end = [&](double near, double far) {
    // Where strut and ball have one radius: h^2 + (near + k h)^2 = R^2.
    const double k = (far - near) / length, ball = 1.8 * near;
    const double h =
        (-near * k + std::sqrt(near * near * k * k + (1 + k * k) * (ball * ball - near * near))) / (1 + k * k);
    return End{h, near + k * h, pi * (ball - h) * (ball - h) * (2 * ball + h) / 3};
  };
  const End a = end(from, to), b = end(to, from);
  const double trunk =
      pi * (length - a.along - b.along) / 3 * (a.radius * a.radius + a.radius * b.radius + b.radius * b.radius);
  return trunk - a.cap - b.cap;
}

// Balls in the sides of the box are halved, and two struts leave each half: no axis of the ball is off that face.
TEST_F(RealiseTest, DiamondThatIsGradedAtItsNodes) {
  const auto made =
      realised(macrostructure(R"(<box dx="10" dy="10" dz="10"/>)") +
                   R"(<unitCells><unitCell id="u" library="diamond"/></unitCells><patterns><pattern id="c" unitCell="u">
    <loop index="i" axis="x" count="1" spacing="10"/><loop index="j" axis="y" count="1" spacing="10"/>
    <loop index="k" axis="z" count="1" spacing="10"/><set parameter="strutRadius" value="0.5 + 0.02*global.x" at="node"/></pattern></patterns>)" +
                   part(R"(<apply pattern="c" operation="intersection"/>)"),
               {.mesh = true});
  const auto radius = [](double x) { return 0.5 + 0.02 * x; };
  const auto ball = [&](double x) { return 4 * pi / 3 * std::pow(1.8 * radius(x), 3); };
  // Corners, middles of the six sides, and the four nodes within.
  double volume =
      (4 * ball(0) + 4 * ball(10)) / 8 + (ball(0) + ball(10) + 4 * ball(5)) / 2 + 2 * (ball(2.5) + ball(7.5));
  // From each node within to one corner, and to three middles of sides.
  for (const double x : {2.5, 7.5})
    for (const double other : {x - 2.5, x - 2.5, x + 2.5, x + 2.5})
      volume += 2 * graded_strut(radius(x), radius(other), 2.5 * std::sqrt(3.0));
  expect_body(made, "lattice", volume);
}

INSTANTIATE_TEST_SUITE_P(Library, LibraryCells, ::testing::ValuesIn(library_cell_names()),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace meso::brep
