// SPDX-License-Identifier: Apache-2.0
// Parts as fields against closed forms, and against the definitions themselves (sdk/membership).
#include "meso/implicit/document_field.hpp"

#include <cmath>
#include <numbers>

#include "document_for_test.hpp"
#include "meso/membership/membership.hpp"

namespace meso::implicit {
namespace {

using std::numbers::pi;

/// At points whose neighbourhood is on one side, both say the same; most points are such.
void expect_agreement(const TestDocument& document, const std::string& part, int count) {
  DiagnosticSink sink;
  const auto judge =
      membership::Membership::make(*document.evaluation, *document.evaluation->find_part(part), {}, sink);
  ASSERT_TRUE(judge) << told(sink);
  const Box3 box = document.field().bounds();
  ASSERT_FALSE(box.empty());
  const Vec3 by = 0.03 * (box.max - box.min);
  RandomPoints points({box.min - by, box.max + by});
  const double delta = 1e-4 * norm(box.max - box.min);
  int asked = 0, wrong = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = points();
    const auto answer = judge->clear_at(p, delta);
    if (answer == membership::Answer::unknown) continue;
    ++asked;
    const bool inside = document.field().value(p) < 0;
    if (inside == (answer == membership::Answer::inside)) continue;
    if (++wrong <= 3)
      ADD_FAILURE() << part << ": " << p.x << " " << p.y << " " << p.z << (inside ? " inside" : " outside");
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(asked, count / 2);
}

TEST(DocumentField, ExampleDocumentsAreWhatTheirDefinitionsSay) {
  int parts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MESO_SOURCE_DIR "/examples/documents")) {
    if (entry.path().extension() != ".meso") continue;
    SCOPED_TRACE(entry.path().filename());
    TestDocument document(entry.path());
    ASSERT_TRUE(document.evaluation);
    for (const Part& part : document.evaluation->document().parts) {
      document.make(part.id.text);
      ASSERT_TRUE(document.made) << told(document.sink);
      expect_agreement(document, part.id.text, 2000);
      ++parts;
    }
  }
  EXPECT_GT(parts, 10);
}

const char* const every_body =
    "<union><difference><box dx='4' dy='3' dz='2'/><cylinder x1='1' y1='1' z1='-1' x2='1.5' y2='1' z2='3' "
    "radius='0.4'/>"
    "<sphere x='3' y='2' z='2' radius='0.7'/></difference>"
    "<translate x='5'><scale x='2' y='1' z='0.5'><sphere radius='0.8'/></scale></translate>"
    "<rotate x='1' y='1' z='0' angle='30deg'><cone x1='0' y1='-3' z1='0' x2='0' y2='-3' z2='2' radius1='1' "
    "radius2='0.3'/></rotate>"
    "<torus x='2' y='6' z='1' ax='1' ay='0' az='1' majorRadius='1.5' minorRadius='0.3'/>"
    "<ellipsoid x='7' y='4' z='0' rx='1' ry='2' rz='0.5'/>"
    "<intersection><box x='-3' dx='2' dy='2' dz='2'/><sphere x='-2' y='1' z='1' radius='1.3'/></intersection>"
    "<extrusion z='4' height='1'><point x='0' y='0'/><point x='3' y='0'/><point x='1' y='1'/><point x='0' "
    "y='3'/></extrusion>"
    "<wedge x='-6' y='-6' z='-2' dx='3' dy='2' dz='2' topX='0.5' topDx='0' topDy='1'/>"
    "<translate x='-5' y='5'><revolution><point r='0' z='0'/><point r='2' z='0'/><point r='1' z='1'/>"
    "<point r='1.5' z='2'/><point r='0' z='3'/></revolution></translate>"
    "<polyhedron><vertex x='12' y='0' z='0'/><vertex x='16' y='0' z='0'/><vertex x='13' y='1' z='0'/>"
    "<vertex x='12' y='4' z='0'/><vertex x='13' y='1' z='3'/><face vertices='3,2,1,0'/><face vertices='0,1,4'/>"
    "<face vertices='1,2,4'/><face vertices='2,3,4'/><face vertices='3,0,4'/></polyhedron>"
    "<transform matrix='0,1,0,10, 1,0.3,0,0, 0,0,1,0' mirror='true'><box dx='1' dy='2' dz='1'/></transform></union>";

TEST(DocumentField, EveryBodyOfATree) {
  const TestDocument document(macrostructure(every_body) + part_of(""));
  expect_agreement(document, "p", 40000);
}

TEST(DocumentField, BodiesSideBySideAreOne) {
  const TestDocument document(
      macrostructure("<union><box dx='1' dy='1' dz='1'/><box x='1' dx='1' dy='1' dz='1'/></union>") + part_of(""));
  EXPECT_LT(document.field().value({1, 0.5, 0.5}), 0);
  EXPECT_GT(document.field().value({2.1, 0.5, 0.5}), 0);
  const TestDocument bored(
      macrostructure("<difference><box dx='1' dy='1' dz='1'/><box x='0.5' dx='0.5' dy='1' dz='1'/></difference>") +
      part_of(""));
  EXPECT_GT(bored.field().value({1, 0.5, 0.5}), 0);  // no skin is left where both end
}

const std::string truss =
    "<box dx='2' dy='2' dz='2'/><beams radius='0.2' nodeRadius='0.3'><node id='a' x='0' y='0' z='0'/><node id='b' "
    "x='2' y='2' "
    "z='2'/><node id='c' x='2' y='0' z='0'/><beam from='a' to='b'/><beam from='a' to='c' radius1='0.1' radius2='0.3' "
    "cap1='butt' cap2='hemisphere'/></beams>";

TEST(DocumentField, LatticesOfStrutsInABody) {
  for (const char* operation : {"intersection", "difference", "union"}) {
    SCOPED_TRACE(operation);
    const TestDocument document(macrostructure("<sphere x='3' y='3' z='3' radius='3.2'/>") +
                                cells(truss, loops(3, 3, 3, 2)) +
                                part_of(std::string("<apply pattern='c' operation='") + operation + "'/>"));
    expect_agreement(document, "p", 20000);
    EXPECT_EQ(document.made->cells_placed, 27u);
    EXPECT_NEAR(document.made->smallest_feature_mm, 0.2, 1e-12);
  }
}

TEST(DocumentField, BoundaryRules) {
  for (const char* rule : {"boundary='dropPartial'", "boundary='keepWhole'", "boundary='dropPartial' test='body'",
                           "boundary='dropPartial' clearance='0.7'"}) {
    SCOPED_TRACE(rule);
    const TestDocument document(
        macrostructure("<sphere x='4' y='4' z='4' radius='3.9'/>") +
        cells("<box dx='1' dy='1' dz='1'/><csg><sphere x='0.5' y='0.5' z='0.5' radius='0.4'/></csg>",
              loops(8, 8, 8, 1)) +
        part_of(std::string("<apply pattern='c' operation='intersection' ") + rule + "/>"));
    expect_agreement(document, "p", 20000);
  }
}

TEST(DocumentField, NamedSurfacesFillBoxesSideBySideWithoutWalls) {
  const std::string gyroid = "<box dx='2' dy='2' dz='2'/><implicit surface='gyroid'/>";
  const TestDocument document(cells(gyroid, loops(3, 2, 2, 2)) +
                              part_of("<apply pattern='c' operation='union'/>", false));
  EXPECT_EQ(document.field().bounds(), (Box3{{0, 0, 0}, {6, 4, 4}}));
  EXPECT_NEAR(volume_by_points(document.field()), 0.5 * 96, 0.1);
  // On the plane between two cells the field goes on as the surface says.
  int inside = 0;
  for (int n = 0; n < 400; ++n) inside += document.field().value({2, 0.0125 + 0.01 * n, 1.3}) < 0;
  EXPECT_GT(inside, 100);
  // Some cells left out: others keep their place.
  const TestDocument holed(cells(gyroid, loops(3, 2, 2, 2) + "<when test='not (i == 1 and j == 0)'/>") +
                           part_of("<apply pattern='c' operation='union'/>", false));
  EXPECT_NEAR(volume_by_points(holed.field()), 0.5 * 80, 0.1);
  EXPECT_GT(holed.field().value({3.5, 1.2, 0.7}), 0);
}

TEST(DocumentField, FormulasThatDoNotRepeatAreCutAtTheirBoxes) {
  // Solid where x < 1 in a cell of width 2: slabs, one wall each.
  const TestDocument document(cells("<box dx='2' dy='2' dz='2'/><implicit field='x - 1'/>", loops(3, 2, 1, 2)) +
                              part_of("<apply pattern='c' operation='union'/>", false));
  EXPECT_NEAR(volume_by_points(document.field()), 0.5 * 6 * 4 * 2, 1e-3);
  EXPECT_LT(document.field().value({2.5, 2, 1}), 0);  // between two cells, both solid
  EXPECT_NEAR(document.field().value({1.9, 1, 1}), 0.1, 1e-5);
}

TEST(DocumentField, KindsOfLevels) {
  const auto volume = [](const std::string& attributes) {
    const TestDocument document(
        cells("<box dx='1' dy='1' dz='1'/><implicit surface='p' " + attributes + "/>", loops(1, 1, 1, 1)) +
        part_of("<apply pattern='c' operation='union'/>", false));
    return volume_by_points(document.field(), 80);
  };
  // Volume fractions of Schwarz's P by quadrature.
  EXPECT_NEAR(volume("isovalue='0.35'"), 0.5999, 3e-3);
  EXPECT_NEAR(volume("isovalue='0.35' kind='exoskeleton'"), 1 - 0.5999, 3e-3);
  EXPECT_NEAR(volume("thickness='0.7' kind='shell'"), 0.1999, 3e-3);
  EXPECT_NEAR(volume("lower='-0.35' upper='0' kind='eccentricShell'"), 0.5 - 0.4001, 3e-3);
}

TEST(DocumentField, ParametersThatChangeFromCellToCell) {
  const TestDocument document(
      "<unitCells><unitCell id='u'><parameter id='t' value='0'/><box dx='1' dy='1' dz='1'/><implicit surface='p' "
      "isovalue='t'/>"
      "</unitCell></unitCells><patterns><pattern id='c' unitCell='u'>" +
      loops(2, 1, 1, 1) + "<set parameter='t' value='i == 0 ? -0.35 : 0.35'/></pattern></patterns>" +
      part_of("<apply pattern='c' operation='union'/>", false));
  EXPECT_NEAR(volume_by_points(document.field(), 80), 0.4001 + 0.5999, 2e-3);
}

TEST(DocumentField, ParametersThatChangeFromPointToPoint) {
  const TestDocument document(
      "<unitCells><unitCell id='u'><parameter id='t' value='0'/><parameter id='half' value='t/2'/><box dx='2' dy='2' "
      "dz='2'/>"
      "<implicit field='z - half'/></unitCell></unitCells><patterns><pattern id='c' unitCell='u'>" +
      loops(3, 1, 1, 2) + "<set parameter='t' value='global.x/2' at='point'/></pattern></patterns>" +
      part_of("<apply pattern='c' operation='union'/>", false));
  // z < x / 4 over 6 x 2.
  EXPECT_NEAR(volume_by_points(document.field()), 2 * 36. / 8, 0.05);
  EXPECT_LT(document.field().value({4, 1, 0.9}), 0);
  EXPECT_GT(document.field().value({4, 1, 1.1}), 0);
}

const std::string polar =
    "<coordinateSystems><coordinateSystem id='s'><axis name='r' kind='distance' x='1'/><axis name='phi' "
    "kind='circular' "
    "z='1'/><axis name='z' kind='linear' z='1'/></coordinateSystem></coordinateSystems>";

std::string tube(const std::string& body, int around, double degrees) {
  return polar + cells("<box dx='1' dy='1' dz='1'/>" + body,
                       "<loop index='i' axis='r' count='2' start='4' spacing='1'/><loop index='j' axis='phi' count='" +
                           std::to_string(around) + "' spacing='" + std::to_string(degrees) +
                           "deg'/><loop index='k' axis='z' count='3' spacing='1.5'/>",
                       "coordinateSystem='s' mapping='conformal'");
}

TEST(DocumentField, ConformalCellsCloseAtTheSeam) {
  const TestDocument document(tube("<implicit surface='gyroid'/>", 20, 18) +
                              part_of("<apply pattern='c' operation='union'/>", false));
  const Field& field = document.field();
  const Box3 box = field.bounds();
  EXPECT_NEAR(box.max.x, 6, 0.01);
  EXPECT_NEAR(box.max.z, 4.5, 0.01);
  // Where the gyroid of a point's own coordinates is negative, the point is inside.
  RandomPoints points(box);
  int inside = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 p = points();
    const double r = std::hypot(p.x, p.y), angle = std::atan2(p.y, p.x);
    const double u = 2 * pi * (r - 4), v = 20 * angle, w = 2 * pi * p.z / 1.5;
    const double gyroid = std::cos(u) * std::sin(v) + std::cos(v) * std::sin(w) + std::cos(w) * std::sin(u);
    const bool within = r > 4 && r < 6 && p.z > 0 && p.z < 4.5;
    if (std::abs(gyroid) < 1e-6 || std::abs(r - 4) < 1e-4 || std::abs(r - 6) < 1e-4) continue;
    ASSERT_EQ(field.value(p) < 0, within && gyroid < 0) << p.x << " " << p.y << " " << p.z;
    inside += within && gyroid < 0;
  }
  EXPECT_GT(inside, 4000);
  for (double z = 0.1; z < 4.4; z += 0.1)
    for (const double r : {4.3, 5.1, 5.7})
      for (const double seam_angle : {0.0, pi})
        EXPECT_NEAR(field.value({r * std::cos(seam_angle - 1e-9), r * std::sin(seam_angle - 1e-9), z}),
                    field.value({r * std::cos(seam_angle + 1e-9), r * std::sin(seam_angle + 1e-9), z}), 1e-7);
}

TEST(DocumentField, ConformalFormulasCellByCell) {
  // Solid in the inner half of each cell's radial fraction.
  const TestDocument document(tube("<implicit field='x - 0.5'/>", 12, 30) +
                              part_of("<apply pattern='c' operation='union'/>", false));
  const double inner = 4.5 * 4.5 - 16, outer = 5.5 * 5.5 - 25;
  EXPECT_NEAR(volume_by_points(document.field(), 40), pi * (inner + outer) * 4.5, 3);
}

/// A part in the cell's box from (4, -1, -2), 3 x 2 x 4 in size; six around, so a unit of y is a twelfth of a turn.
std::string bent_part(const std::string& body, const std::string& steps, const std::string& clip = "clipToBox='true'") {
  const std::string pattern =
      "<loop index='i' axis='r' count='1' start='4' spacing='3'/><loop index='j' axis='phi' count='6' start='-30deg' "
      "spacing='60deg'/><loop index='k' axis='z' count='1' start='-2' spacing='4'/>";
  return polar + macrostructure(body) + "<unitCells><unitCell id='u' " + clip +
         "><box x='4' y='-1' z='-2' dx='3' dy='2' dz='4'/><part ref='q'/></unitCell><unitCell id='bar'><beams "
         "radius='0.4' cap='sphere'><node id='a' x='5.5' y='-0.3' z='-1'/><node id='b' x='5.5' y='-0.3' z='1'/><beam "
         "from='a' to='b'/></beams></unitCell></unitCells><patterns><pattern id='bars' unitCell='bar'><list><place "
         "at='0'/></list></pattern><pattern id='c' unitCell='u' coordinateSystem='s' mapping='conformal'>" +
         pattern + "</pattern></patterns><parts><part id='q'" + (steps.empty() ? " macrostructure='m'>" : ">") + steps +
         "</part><part id='p'><apply pattern='c' operation='union'/></part></parts>";
}

// What stands at r takes up r times its angle: the volume is that of the moment about the z axis (Pappus).
TEST(DocumentField, PartsAreBentPointByPoint) {
  const double turn = 2 * pi;
  const TestDocument ball(bent_part("<sphere x='5.5' y='0.1' z='0.5' radius='0.8'/>", ""));
  EXPECT_NEAR(volume_by_points(ball.field()), 6 * 4. / 3 * pi * std::pow(0.8, 3) * 5.5 * turn / 12, 0.3);
  // Cut to the bent box where it begins, at 4.
  const TestDocument cut(bent_part("<box x='3' y='-1' z='-1' dx='2' dy='2' dz='1'/>", ""));
  RandomPoints points({{-6, -6, -2}, {6, 6, 2}});
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p = points();
    const double r = std::hypot(p.x, p.y), outside = std::max({4 - r, r - 5, -1 - p.z, p.z});
    if (std::abs(outside) < 1e-4) continue;
    ASSERT_EQ(cut.field().value(p) < 0, outside < 0) << p.x << " " << p.y << " " << p.z;
  }
  // Struts are asked for, not written out.
  const TestDocument bars(bent_part("<sphere radius='1'/>", "<apply pattern='bars' operation='union'/>"));
  const double bar = pi * 0.16 * 2 + 4. / 3 * pi * 0.064;
  EXPECT_NEAR(volume_by_points(bars.field()), 6 * bar * 5.5 * turn / 12, 0.5);
  for (int n = 0; n < 6; ++n) {
    const double angle = turn * (-0.3 / 12 + n / 6.);
    EXPECT_LT(bars.field().value({5.5 * std::cos(angle), 5.5 * std::sin(angle), 1.3}), 0);
    EXPECT_GT(bars.field().value({5.5 * std::cos(angle), 5.5 * std::sin(angle), 1.5}), 0);
  }
}

TEST(DocumentField, SphericalAndConicalElements) {
  const std::string systems =
      "<coordinateSystems><coordinateSystem id='s'><placement matrix='0,-1,0,1, 1,0,0,2, 0,0,1,3'/><axis name='r' "
      "kind='distance' "
      "x='1'/><axis name='t' kind='circular' z='1'/><axis name='f' kind='circular' y='-1'/></coordinateSystem>"
      "<coordinateSystem id='c'><axis name='r' kind='distance' x='1' z='1'/><axis name='t' kind='circular' "
      "z='1'/><axis name='h' "
      "kind='linear' z='1'/></coordinateSystem><coordinateSystem id='o'><axis name='a' kind='linear' x='1'/><axis "
      "name='b' "
      "kind='linear' x='3' y='4'/><axis name='c' kind='linear' z='1' x='1'/></coordinateSystem></coordinateSystems>";
  const auto element = [](const std::string& system, const std::string& ranges) {
    return macrostructure("<volumeElement coordinateSystem='" + system + "'>" + ranges + "</volumeElement>") +
           part_of("");
  };
  const TestDocument sector(systems +
                            element("s",
                                    "<range axis='r' from='2' to='5'/><range axis='t' from='20deg' to='200deg'/>"
                                    "<range axis='f' from='-30deg' to='90deg'/>"));
  expect_agreement(sector, "p", 20000);
  const TestDocument over_the_pole(systems +
                                   element("s",
                                           "<range axis='r' from='0' to='5'/><range axis='t' from='0deg' to='90deg'/>"
                                           "<range axis='f' from='100deg' to='170deg'/>"));
  expect_agreement(over_the_pole, "p", 20000);
  const TestDocument cone(systems + element("c",
                                            "<range axis='r' from='1' to='3'/><range axis='t' from='0' to='300deg'/>"
                                            "<range axis='h' from='-1' to='1'/>"));
  expect_agreement(cone, "p", 20000);
  const TestDocument oblique(systems + element("o",
                                               "<range axis='a' from='1' to='3'/><range axis='b' from='0' to='2'/>"
                                               "<range axis='c' from='-1' to='1'/>"));
  expect_agreement(oblique, "p", 20000);
}

TEST(DocumentField, LooseFragments) {
  // Two bars, each cut into a long and a short piece.
  const auto text = [](const std::string& rule) {
    return macrostructure("<union><box dx='10' dy='1' dz='1'/><box y='4' dx='10' dy='1' dz='1'/></union>") +
           cells("<csg><box x='7' y='-1' z='-1' dx='1' dy='7' dz='3'/></csg>", "<list><place at='0,0,0'/></list>") +
           part_of("<apply pattern='c' operation='difference'" + rule + "/>");
  };
  const TestDocument kept(text("")), dropped(text(" fragments='drop'")), refused(text(" fragments='error'"));
  for (const double y : {0.5, 4.5}) {
    EXPECT_LT(kept.field().value({9, y, 0.5}), 0);
    EXPECT_LT(dropped.field().value({3, y, 0.5}), 0);
    EXPECT_GT(dropped.field().value({9, y, 0.5}), 0);
  }
  EXPECT_NEAR(dropped.field().value({6.9, 0.5, 0.5}), -0.1, 1e-5);  // what stays keeps its surface
  EXPECT_EQ(dropped.made->fragments, 2u);
  EXPECT_FALSE(refused.made);
  EXPECT_EQ(refused.code(), Code::geometry_fragments);
}

TEST(DocumentField, PartsInCellsAndImports) {
  const std::string text = macrostructure("<sphere radius='1'/>") +
                           "<parts><part id='q' macrostructure='m'><apply pattern='c' operation='union'/></part><part "
                           "id='p'><apply pattern='d' "
                           "operation='union'/></part></parts><unitCells><unitCell id='u'><csg><box x='0.5' dx='1' "
                           "dy='0.2' dz='0.2'/></csg></unitCell>"
                           "<unitCell id='v'><part ref='q'/></unitCell></unitCells><patterns><pattern id='c' "
                           "unitCell='u'><list><place at='0,0,0'/></list>"
                           "</pattern><pattern id='d' unitCell='v'>" +
                           loops(2, 2, 1, 3) + "<rotate x='0' y='0' z='1' angle='30deg'/></pattern></patterns>";
  const TestDocument document(text);
  expect_agreement(document, "p", 20000);
}

// Inside of the body's box, at the middle of a bore or at its wall.
TEST(DocumentField, AFieldInABoreMissesThePart) {
  const auto told_of = [](const std::string& x, const std::string& operation) {
    const TestDocument document(
        macrostructure(
            "<difference><box x='-9' y='-9' z='-9' dx='18' dy='18' dz='18'/><cylinder x1='0' y1='0' z1='-10' "
            "x2='0' y2='0' z2='10' radius='5'/></difference>") +
        "<unitCells><unitCell id='u'><csg><sphere radius='1'/></csg></unitCell></unitCells><vectorFields><vectorField "
        "id='f'><structure records='1'><component name='s'/><regularGrid><axis name='x' start='" +
        x +
        "' spacing='1' count='1'/></regularGrid></structure><embedded>AAAAAAAAAAA=</embedded></vectorField>"
        "</vectorFields><patterns><pattern id='c' unitCell='u'><scatter field='f'/></pattern></patterns>" +
        part_of("<apply pattern='c' operation='" + operation + "'/>"));
    return document.made ? Code::internal : document.code();
  };
  EXPECT_EQ(told_of("1", "difference"), Code::field_misses_part);
  EXPECT_EQ(told_of("1", "intersection"), Code::field_misses_part);
  EXPECT_EQ(told_of("1", "union"), Code::internal);
  EXPECT_EQ(told_of("4.5", "difference"), Code::internal);
}

TEST(DocumentField, WhatCannotBeIsTold) {
  const auto code = [](const std::string& text) {
    TestDocument document(text);
    EXPECT_FALSE(document.made);
    EXPECT_EQ(document.sink.error_count(), 1u) << told(document.sink);
    return document.code();
  };
  const std::string whole = part_of("<apply pattern='c' operation='union'/>", false);
  EXPECT_EQ(code(tube("<implicit surface='gyroid'/>", 21, 18) + whole), Code::conformal_overlap);
  EXPECT_EQ(code(bent_part("<sphere x='5.5' radius='0.8'/>", "", "")), Code::conformal_not_realised);
  const std::string swept =
      "<coordinateSystems><coordinateSystem id='s'><axis name='r' kind='distance' x='1'/><axis name='t' "
      "kind='circular' z='1'/>"
      "<axis name='h' kind='linear' y='1'/></coordinateSystem></coordinateSystems>";
  EXPECT_EQ(code(swept +
                 macrostructure("<volumeElement coordinateSystem='s'><range axis='r' from='1' to='2'/><range axis='t' "
                                "from='0' to='1'/><range axis='h' from='0' to='1'/></volumeElement>") +
                 part_of("")),
            Code::conformal_not_inverted);
}

}  // namespace
}  // namespace meso::implicit
