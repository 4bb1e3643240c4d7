// SPDX-License-Identifier: Apache-2.0
// Values that differ from point to point, shares, walls, blends and sizes of implicit cells, against closed forms and
// against integrals of the result.
#include <array>
#include <cmath>
#include <numbers>

#include "density_spacing.hpp"
#include "document_for_test.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"

namespace meso::implicit {
namespace {

using std::numbers::pi;

/// Cells of 10 mm over a block; the part is the pattern alone.
std::string block(const std::string& body, const std::string& instructions = "", int nx = 2, int ny = 2, int nz = 2,
                  const std::string& parameters = "") {
  return cells(parameters + "<box dx='10' dy='10' dz='10'/>" + body, loops(nx, ny, nz, 10) + instructions) +
         part_of("<apply pattern='c' operation='union'/>", false);
}
/// The share that a field fills of a slab of its box.
double share(const Field& field, const Box3& box, int along = 64) {
  int inside = 0;
  std::vector<Vec3> row(static_cast<std::size_t>(along));
  std::vector<double> values(row.size());
  for (int k = 0; k < along; ++k)
    for (int j = 0; j < along; ++j) {
      for (int i = 0; i < along; ++i) {
        const Vec3 u{(i + 0.4871) / along, (j + 0.5119) / along, (k + 0.4933) / along};
        for (std::size_t a = 0; a < 3; ++a)
          row[static_cast<std::size_t>(i)][a] = box.min[a] + u[a] * (box.max[a] - box.min[a]);
      }
      field.values(row, values);
      for (const double v : values) inside += v < 0;
    }
  return inside / (double(along) * along * along);
}

double volume_on_grid(const Term& body, const Box3& box, double spacing) {
  Grid grid{.box = box};
  for (std::size_t a = 0; a < 3; ++a)
    grid.nodes[a] = static_cast<std::int32_t>(std::ceil((box.max[a] - box.min[a]) / spacing)) + 1;
  DiagnosticSink sink;
  TriangleMesh mesh;
  MemoryMeshSink into(mesh);
  const auto source = compile(body, grid, {}, {}, sink);
  EXPECT_TRUE(source && contour(*source, into, {}, {}, sink));
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) volume += dot(mesh.points[a], cross(mesh.points[b], mesh.points[c])) / 6;
  return volume;
}

// At the spacing that is told, meshes hold the share to 0.2 %; at three times that, nine times less well. Shares of
// levels by an independent count.
TEST(Gradings, TellTheSpacingThatHoldsAShare) {
  const std::array<Term, 3> xyz{Term::coordinate(0), Term::coordinate(1), Term::coordinate(2)};
  const auto term = [&](const char* text) {
    return Term::from_expression(*expr::parse_expression(text, LengthUnit::millimeter).expression, xyz);
  };
  const Term gyroid = term("cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)"),
             p = term("cos(2*pi*x) + cos(2*pi*y) + cos(2*pi*z)"), level = Term::constant(0.35);
  const struct {
    Term body;
    double share;
  } cases[] = {{gyroid + level, 0.3871}, {p + level, 0.4001}, {abs(gyroid) - level, 0.2259}};
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  for (const auto& [body, share] : cases) {
    const double spacing = spacing_for_share(body, box, share);
    EXPECT_GT(spacing, 1.0 / 100) << share;
    EXPECT_LT(spacing, 1.0 / 15) << share;
    EXPECT_NEAR(volume_on_grid(body, box, spacing) / share, 1, 0.003) << share;
    EXPECT_GT(std::fabs(volume_on_grid(body, box, 3 * spacing) / share - 1), 0.008) << share;
  }
}

TEST(Gradings, TellTheSpacingOfTheLeastShare) {
  const TestDocument graded(block("<implicit surface='gyroid' density='s'/>",
                                  "<set parameter='s' value='0.15 + 0.02*global.x' at='point'/>", 2, 1, 1,
                                  "<parameter id='s' value='0.3'/>"));
  const TestDocument sparse(block("<implicit surface='gyroid' density='0.15'/>", "", 1, 1, 1));
  const TestDocument dense(block("<implicit surface='gyroid' density='0.3'/>", "", 1, 1, 1));
  EXPECT_NEAR(graded.made->density_spacing_mm, sparse.made->density_spacing_mm, 0.02);
  EXPECT_LT(sparse.made->density_spacing_mm, 0.8 * dense.made->density_spacing_mm);
  const TestDocument level(block("<implicit surface='gyroid'/>", "", 1, 1, 1));
  EXPECT_EQ(level.made->density_spacing_mm, HUGE_VAL);
}

TEST(Gradings, AParameterFollowsPositionFromPointToPoint) {
  // x below a height that grows with y: a wedge.
  const TestDocument document(block("<implicit field='z - h'/>", "<set parameter='h' value='global.y/2' at='point'/>",
                                    1, 1, 1, "<parameter id='h' value='1'/>"));
  EXPECT_NEAR(volume_by_points(document.field()), 10 * 10 * 5 / 2.0 * 10 / 10, 0.5);
  EXPECT_LT(document.field().value({5, 8, 3.9}), 0);
  EXPECT_GT(document.field().value({5, 8, 4.1}), 0);
}

const char* const linear_field =
    "<vectorFields><vectorField id='g'><structure records='4'><component name='rho'/>"
    "<regularGrid><axis name='x' start='0' spacing='20' count='2'/><axis name='y' start='0' spacing='20' count='2'/>"
    "</regularGrid></structure><embedded>%s</embedded><interpolation method='linear'/>%s</vectorField></vectorFields>";

/// rho = 0.2 at x = 0 and 0.6 at x = 20.
std::string field_of_density(const std::string& outside = "") {
  const std::string values = "mpmZmZmZyT+amZmZmZnJPzMzMzMzM+M/MzMzMzMz4z8=";
  std::string text = linear_field;
  text.replace(text.find("%s"), 2, values);
  text.replace(text.find("%s"), 2, outside);
  return text;
}

TEST(Gradings, AParameterFollowsAFieldFromPointToPoint) {
  const TestDocument document(field_of_density() + block("<implicit surface='gyroid' density='rho'/>",
                                                         "<sample field='g'/><set parameter='rho' value='g.rho' "
                                                         "at='point'/>",
                                                         2, 2, 2, "<parameter id='rho' value='0.4'/>"));
  // The share of a slab is that in its middle.
  EXPECT_NEAR(share(document.field(), {{0, 0, 0}, {10, 20, 20}}), 0.3, 0.006);
  EXPECT_NEAR(share(document.field(), {{10, 0, 0}, {20, 20, 20}}), 0.5, 0.006);
  EXPECT_NEAR(share(document.field(), {{0, 0, 0}, {20, 20, 20}}), 0.4, 0.002);
}

TEST(Gradings, WhereAFieldHasNoValueIsTold) {
  const TestDocument document(field_of_density() + block("<implicit surface='gyroid' density='rho'/>",
                                                         "<sample field='g' x='1' y='1' z='1'/>"
                                                         "<set parameter='rho' value='g.rho' at='point'/>",
                                                         3, 1, 1, "<parameter id='rho' value='0.4'/>"));
  EXPECT_FALSE(document.made);
  EXPECT_EQ(document.code(), Code::field_outside) << told(document.sink);
}

class Density : public testing::TestWithParam<const char*> {};

TEST_P(Density, ShareIsRealisedWithinTwoThousandths) {
  for (const char* const kind : {"endoskeleton", "exoskeleton", "shell"})
    for (const double target : {0.12, 0.6}) {
      const TestDocument document(block(std::string("<implicit surface='") + GetParam() + "' kind='" + kind +
                                            "' density='" + std::to_string(target) + "'/>",
                                        "", 1, 1, 1));
      EXPECT_NEAR(share(document.field(), {{0, 0, 0}, {10, 10, 10}}, 83), target, 0.002) << GetParam() << " " << kind;
    }
}
INSTANTIATE_TEST_SUITE_P(Surfaces, Density, testing::Values("gyroid", "p", "d", "iwp", "neovius", "frd"));

TEST(Gradings, LevelOfADensityIsThatOfClosedForms) {
  // The share below a level of z/10 is the level; above the ball's level it is 1 - 4/3 pi r^3.
  const TestDocument plane(block("<implicit field='z' density='0.37'/>", "", 1, 1, 1));
  EXPECT_LT(plane.field().value({3, 4, 3.69}), 0);
  EXPECT_GT(plane.field().value({3, 4, 3.71}), 0);
  const double r = 4;
  const std::string filled = std::to_string(4 * pi / 3 * r * r * r / 1000);
  const TestDocument ball(block("<implicit field='(x-5)^2+(y-5)^2+(z-5)^2' density='" + filled + "'/>", "", 1, 1, 1));
  EXPECT_LT(ball.field().value({5, 5, 5 + r - 0.02}), 0);
  EXPECT_GT(ball.field().value({5, 5, 5 + r + 0.02}), 0);
}

TEST(Gradings, DensitiesThatNoLevelReachesTellWhatCanBe) {
  // Half of the cell is flat at 0: no level bounds a share between 0 and 0.5.
  const TestDocument flat(block("<implicit field='max(z - 5, 0)' density='0.3'/>", "", 1, 1, 1));
  EXPECT_FALSE(flat.made);
  ASSERT_EQ(flat.code(), Code::density_unreachable) << told(flat.sink);
  EXPECT_NE(told(flat.sink).find("shares between 0.5 and 1 are possible"), std::string::npos) << told(flat.sink);
  // A law that leaves 0 ... 1 says where.
  const TestDocument law(block("<implicit surface='p' density='rho'/>",
                               "<set parameter='rho' value='global.x/10' at='point'/>", 2, 1, 1,
                               "<parameter id='rho' value='0.4'/>"));
  EXPECT_FALSE(law.made);
  EXPECT_EQ(law.code(), Code::density_unreachable) << told(law.sink);
  EXPECT_EQ(law.sink.diagnostics()[0].path.substr(law.sink.diagnostics()[0].path.size() - 8), "@density");
}

/// Lengths of what a line cuts out of the body, around each of its crossings of the function's zero.
TEST(Gradings, AWallIsAsThickAsItSays) {
  const double wall = 0.8;
  const TestDocument document(block("<implicit surface='gyroid' kind='shell' wall='0.8'/>", "", 1, 1, 1));
  DiagnosticSink sink;
  const Field gyroid = Field::surface("gyroid", sink)->scaled(10);
  RandomPoints points({{1, 1, 1}, {9, 9, 9}});
  double worst = 0;
  int measured = 0;
  for (int n = 0; n < 400; ++n) {
    Vec3 p = points();
    for (int i = 0; i < 30; ++i) {  // onto the surface
      const Vec3 g = gyroid.gradient(p);
      p = p - (gyroid.value(p) / dot(g, g)) * g;
    }
    const Vec3 g = gyroid.gradient(p), normal = g / norm(g);
    if (std::min({p.x, p.y, p.z}) < 1 || std::max({p.x, p.y, p.z}) > 9) continue;
    double thickness = 0;
    for (const double side : {-1.0, 1.0}) {
      double in = 0, out = wall;
      ASSERT_LT(document.field().value(p), 0);
      for (int i = 0; i < 40; ++i) {
        const double middle = (in + out) / 2;
        (document.field().value(p + side * middle * normal) < 0 ? in : out) = middle;
      }
      thickness += in;
    }
    worst = std::max(worst, std::abs(thickness - wall));
    ++measured;
  }
  EXPECT_GT(measured, 200);
  EXPECT_LT(worst, 0.002 * wall);
}

TEST(Gradings, AWallInATubeIsMeasuredInTheWorldNotInTheCell) {
  // Cells twice as wide outside as inside; r - 15 is the surface, so the wall is a tube of exact radii.
  const std::string system =
      "<coordinateSystems><coordinateSystem id='s'><axis name='r' kind='distance' x='1'/><axis name='t' "
      "kind='circular' z='1'/><axis name='h' kind='linear' z='1'/></coordinateSystem></coordinateSystems>";
  const std::string cell = "<box dx='1' dy='1' dz='1'/><implicit field='x^3 - 0.125' kind='shell' wall='1.2'/>";
  const TestDocument document(
      system +
      cells(cell,
            "<loop index='i' axis='r' count='1' start='10' spacing='10'/><loop index='j' axis='t' count='24' "
            "spacing='15deg'/><loop index='k' axis='h' count='2' spacing='10'/>",
            "coordinateSystem='s' mapping='conformal'") +
      part_of("<apply pattern='c' operation='union'/>", false));
  for (const double angle : {0.1, 1.0, 3.1415, 5.9}) {
    const Vec3 way{std::cos(angle), std::sin(angle), 0};
    EXPECT_LT(document.field().value(15.59 * way + Vec3{0, 0, 7}), 0);
    EXPECT_LT(document.field().value(14.41 * way + Vec3{0, 0, 7}), 0);
    EXPECT_GT(document.field().value(15.61 * way + Vec3{0, 0, 7}), 0);
    EXPECT_GT(document.field().value(14.39 * way + Vec3{0, 0, 7}), 0);
  }
}

TEST(Gradings, ABlendOfTwoSurfacesKeepsTheDensityAllTheWay) {
  const TestDocument document(
      block("<implicit surface='gyroid' density='0.3'><blend surface='neovius' weight='w'/></implicit>",
            "<set parameter='w' value='global.x/40' at='point'/>", 4, 1, 1, "<parameter id='w' value='0'/>"));
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(share(document.field(), {{10.0 * i, 0, 0}, {10.0 * (i + 1), 10, 10}}), 0.3, 0.012) << i;
  EXPECT_NEAR(share(document.field(), {{0, 0, 0}, {40, 10, 10}}, 96), 0.3, 0.003);
  // At its ends it is the one and the other, by their tables' levels.
  const TestDocument gyroid(block("<implicit surface='gyroid' density='0.3'/>", "", 4, 1, 1));
  for (const Vec3 p : {Vec3{0.001, 3, 4}, Vec3{0.001, 7, 2}, Vec3{0.001, 5, 5}})
    EXPECT_EQ(document.field().value(p) < 0, gyroid.field().value(p) < 0);
}

TEST(Gradings, WeightsBeyondOneAreTold) {
  const TestDocument document(block("<implicit surface='gyroid'><blend surface='p' weight='w'/></implicit>",
                                    "<set parameter='w' value='global.x/15' at='point'/>", 2, 1, 1,
                                    "<parameter id='w' value='0'/>"));
  EXPECT_FALSE(document.made);
  ASSERT_EQ(document.code(), Code::blend_weight) << told(document.sink);
}

TEST(Gradings, CellsThatGrowAlongAnAxisDoNotTear) {
  // size = 2 + x/10: the phase is 10 ln(1 + x/20); the surface cos(2 pi phase) = 0 stands where that says.
  const TestDocument document(
      cells(
          "<box dx='1' dy='1' dz='1'/><implicit field='cos(2*pi*x)'/>",
          "<loop index='i' axis='x' count='10' size='2 + x/10'/><loop index='j' axis='y' count='1' spacing='5'/><loop "
          "index='k' axis='z' count='1' spacing='5'/>",
          "mapping='conformal'") +
      part_of("<apply pattern='c' operation='union'/>", false));
  const double end = 20 * (std::exp(1.0) - 1);
  EXPECT_NEAR(document.field().bounds().max.x, end, 1e-6);
  for (int n = 0; n < 20; ++n) {
    const double phase = 0.25 + 0.5 * n, x = 20 * (std::exp(phase / 10) - 1);
    const double before = document.field().value({x - 1e-4, 2, 2}), after = document.field().value({x + 1e-4, 2, 2});
    EXPECT_EQ(before > 0, n % 2 == 0) << n;
    EXPECT_EQ(after > 0, n % 2 == 1) << n;
  }
}

TEST(Gradings, AMirrorMakesTheSecondHalfOfTheCellTheFirst) {
  const TestDocument document(block("<implicit field='x + y/4 - 3' mirror='x'/>", "", 2, 1, 1));
  RandomPoints points({{0, 0, 0}, {10, 10, 10}});
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = points();
    const bool inside = document.field().value(p) < 0;
    if (std::abs(p.x + p.y / 4 - 3) < 1e-3 || std::abs(10 - p.x + p.y / 4 - 3) < 1e-3) continue;
    EXPECT_EQ(inside, std::min(p.x, 10 - p.x) + p.y / 4 < 3);
    EXPECT_EQ(inside, document.field().value({10 + p.x, p.y, p.z}) < 0);
  }
}

const char* const tee =
    "<macrostructures><macrostructure id='m'><csg><box x='-10' y='-10' z='-2' dx='20' dy='20' dz='2'/></csg>"
    "</macrostructure><macrostructure id='web'><csg><box x='-1' y='-5' z='-1' dx='2' dy='10' dz='9'/></csg>"
    "</macrostructure></macrostructures>";

TEST(Gradings, AUnionWithARadiusHasARoundFillet) {
  const TestDocument document(
      std::string(tee) +
      "<parts><part id='w' macrostructure='web'/><part id='p' macrostructure='m'><apply part='w' operation='union' "
      "radius='3'/></part></parts>");
  // Beside the web's foot a circle of radius 3 about (4, 3) bounds the fillet.
  for (double angle = 185; angle < 266; angle += 10) {
    const double c = std::cos(angle * pi / 180), s = std::sin(angle * pi / 180);
    EXPECT_GT(document.field().value({4 + 2.999 * c, 0, 3 + 2.999 * s}), 0) << angle;
    EXPECT_LT(document.field().value({4 + 3.001 * c, 0, 3 + 3.001 * s}), 0) << angle;
  }
  EXPECT_GT(document.field().value({4.001, 0, 0.001}), 0);
  EXPECT_LE(document.field().bounds().max.z, 8 + 1e-9 + 3 * (1 - std::numbers::sqrt2 / 2));
}

TEST(Gradings, AnIntersectionKeepsASkinOfItsThickness) {
  const std::string pattern =
      cells("<box dx='10' dy='10' dz='10'/><implicit field='1'/>", loops(2, 2, 2, 10));  // nothing at all
  const TestDocument document(macrostructure("<box dx='20' dy='20' dz='20'/>") + pattern +
                              part_of("<apply pattern='c' operation='intersection' skin='1.5'/>"));
  EXPECT_NEAR(volume_by_points(document.field(), 80), 20 * 20 * 20 - 17 * 17 * 17, 60);
  EXPECT_LT(document.field().value({10, 10, 1.499}), 0);
  EXPECT_GT(document.field().value({10, 10, 1.501}), 0);
}

TEST(Gradings, ADifferenceLeavesASkinOfItsThickness) {
  const std::string pattern =
      cells("<box dx='10' dy='10' dz='10'/><implicit field='-1'/>", loops(2, 2, 2, 10));  // all of each box
  const TestDocument document(macrostructure("<box dx='20' dy='20' dz='20'/>") + pattern +
                              part_of("<apply pattern='c' operation='difference' skin='1.5'/>"));
  EXPECT_NEAR(volume_by_points(document.field(), 80), 20 * 20 * 20 - 17 * 17 * 17, 60);
  EXPECT_LT(document.field().value({10, 10, 1.499}), 0);
  EXPECT_GT(document.field().value({10, 10, 1.501}), 0);
}

}  // namespace
}  // namespace meso::implicit
