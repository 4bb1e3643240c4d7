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

INSTANTIATE_TEST_SUITE_P(Library, LibraryCells, ::testing::ValuesIn(library_cell_names()),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace meso::brep
