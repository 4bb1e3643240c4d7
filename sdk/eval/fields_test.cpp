// SPDX-License-Identifier: Apache-2.0
// Patterns over vector fields: scatter, sort, thin, sample, orient.
#include <gmock/gmock.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <random>

#include "document_text.hpp"
#include "meso/base/number.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "meso/fields/base64.hpp"

namespace meso::eval {
namespace {

using testing::ElementsAre;

std::string embedded(const std::vector<double>& values) {
  return "<embedded>" +
         fields::encode_base64(reinterpret_cast<const std::byte*>(values.data()), values.size() * sizeof(double)) +
         "</embedded>";
}
std::string position(const std::string& unit = "") {
  std::string text;
  for (const char* name : {"x", "y", "z"})
    text += std::string("<component name='") + name + "' role='position'" +
            (unit.empty() ? "" : " unit='" + unit + "'") + "/>";
  return text;
}
std::string field(const std::string& id, std::size_t records, const std::string& structure, const std::string& values,
                  const std::string& more = "") {
  return "<vectorFields><vectorField id='" + id + "'><structure records='" + std::to_string(records) + "'>" +
         structure + "</structure>" + values + more + "</vectorField></vectorFields>";
}
const std::string cell = "<parameter id='a' value='0'/><parameter id='b' value='0'/><csg><sphere radius='1'/></csg>";

std::vector<double> column(const std::vector<CellCopy>& cells, std::size_t parameter) {
  std::vector<double> result;
  result.reserve(cells.size());
  for (const CellCopy& c : cells) result.push_back(c.parameters.at(parameter));
  return result;
}
std::vector<std::int64_t> records_of(const std::vector<CellCopy>& cells) {
  std::vector<std::int64_t> result;
  result.reserve(cells.size());
  for (const CellCopy& c : cells) result.push_back(c.index.at(0));
  return result;
}

const std::string four = field("f", 4, position() + "<component name='s'/><points/>",
                               embedded({0, 0, 0, 5, 1, 0, 0, 7, 2, 0, 0, 7, 3, 0, 0, 6}));

TEST(Scatter, PlacesACellAtEveryRecord) {
  const auto cells =
      cells_of(pattern_text("<scatter field='f' index='n'/><set parameter='a' value='f.s + 10*n'/>", cell, "", four));
  EXPECT_THAT(records_of(cells), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(column(cells, 0), ElementsAre(5, 17, 27, 36));
  EXPECT_EQ(cells[2].world_from_cell.translation, (Vec3{2, 0, 0}));
}

TEST(Scatter, SortsStablyAndThinsGreedily) {
  const auto order = [](const std::string& inner) {
    return records_of(cells_of(pattern_text("<scatter field='f'>" + inner + "</scatter>", cell, "", four)));
  };
  EXPECT_THAT(order("<sort by='f.s'/>"), ElementsAre(0, 3, 1, 2));
  EXPECT_THAT(order("<sort by='f.s' order='descending'/>"), ElementsAre(1, 2, 3, 0));
  EXPECT_THAT(order("<thin distance='1'/>"), ElementsAre(0, 2));
  EXPECT_THAT(order("<sort by='f.s' order='descending'/><thin distance='1'/>"), ElementsAre(1, 3));
}

// What sorting, thinning and searching take is asked for before; walking over records takes nothing.
TEST(Scatter, ObeysTheMemoryBudget) {
  const auto faults = [](const std::string& pattern) {
    return faults_of(pattern_text(pattern, cell, "", four), {.run = {.max_memory_bytes = 80}});
  };
  EXPECT_THAT(faults("<scatter field='f'/>"), ElementsAre());
  EXPECT_THAT(faults("<scatter field='f'><sort by='f.s'/></scatter>"), ElementsAre("LIMIT_MEMORY"));
  EXPECT_THAT(faults("<scatter field='f'><thin distance='1'/></scatter>"), ElementsAre("LIMIT_MEMORY"));
}

TEST(Scatter, DroppedCellsKeepTheirRecord) {
  const auto cells = cells_of(pattern_text("<scatter field='f'/><when test='f.s == 7'/>", cell, "", four));
  EXPECT_THAT(records_of(cells), ElementsAre(1, 2));
}

TEST(Scatter, DefaultsOfTheCellSeeTheRecord) {
  const std::string own = "<parameter id='a' value='f.s/2'/><csg><sphere radius='a'/></csg>";
  EXPECT_THAT(column(cells_of(pattern_text("<scatter field='f'/>", own, "", four)), 0), ElementsAre(2.5, 3.5, 3.5, 3));
}

TEST(Scatter, ConvertsUnits) {
  const std::string inches =
      field("f", 1, position("in") + "<component name='s' unit='deg'/><points/>", embedded({1, 2, 3, 180}));
  const auto cells = cells_of(pattern_text(
      "<scatter field='f'/><set parameter='a' value='f.s'/><set parameter='b' value='f.y'/>", cell, "", inches));
  expect_near(cells.at(0).world_from_cell.translation, {25.4, 50.8, 76.2});
  EXPECT_NEAR(cells[0].parameters[0], 3.14159265358979323846, 1e-15);
  EXPECT_NEAR(cells[0].parameters[1], 50.8, 1e-13);
}

const std::string polar =
    "<coordinateSystems><coordinateSystem id='polar'><axis name='r' kind='distance' x='1'/>"
    "<axis name='phi' kind='circular' z='1'/></coordinateSystem></coordinateSystems>";
const std::string polar_grid = polar + field("f", 6,
                                             "<component name='s'/><regularGrid coordinateSystem='polar'>"
                                             "<axis name='r' start='10' spacing='10' count='2'/><axis name='phi' "
                                             "start='0' spacing='90deg' count='3'/></regularGrid>",
                                             embedded({10, 11, 12, 20, 21, 22}), "<interpolation method='linear'/>");

TEST(Scatter, StandsInTheFieldsSystemOrUnturnedAtTheSamePlace) {
  const auto own = cells_of(pattern_text("<scatter field='f'/>", cell, "coordinateSystem='polar'", polar_grid));
  const auto plain = cells_of(pattern_text("<scatter field='f'/>", cell, "", polar_grid));
  ASSERT_EQ(own.size(), 6U);
  expect_near(own[4].world_from_cell.translation, {0, 20, 0});
  expect_near(own[4].world_from_cell.linear * Vec3{1, 0, 0}, {0, 1, 0});
  expect_near(plain[4].world_from_cell.translation, {0, 20, 0});
  EXPECT_EQ(plain[4].world_from_cell.linear, Mat3{});
}

TEST(Sample, GridsInPolarCoordinatesAreLinearInThem) {
  const auto cells = cells_of(pattern_text(
      "<list><place at='0, 15, 3'/><place at='-14, 0, 0'/></list><sample field='f'/><set parameter='a' value='f.s'/>",
      cell, "", polar_grid));
  EXPECT_NEAR(cells.at(0).parameters[0], 16, 1e-12);
  EXPECT_NEAR(cells.at(1).parameters[0], 12 + 4, 1e-12);
}

// s = 10 + (r - 10) + phi/90deg: the gradient is 1 along r and (2/pi)/r along phi.
TEST(Sample, GradientsAreGlobalVectors) {
  const auto cells =
      cells_of(pattern_text("<list><place at='0, 15'/></list><sample field='f'/><set parameter='a' "
                            "value='f.s_dx'/><set parameter='b' value='f.s_dy'/>",
                            cell, "", polar_grid));
  EXPECT_NEAR(cells.at(0).parameters[0], -2 / 3.14159265358979323846 / 15, 1e-12);
  EXPECT_NEAR(cells.at(0).parameters[1], 1, 1e-12);
}

TEST(Sample, OutsideFollowsTheRule) {
  const auto at = [](const std::string& outside) {
    return pattern_text("<list><place at='9'/></list><sample field='f'/><set parameter='a' value='f.s'/>", cell, "",
                        field("f", 4, position() + "<component name='s'/><points/>",
                              embedded({0, 0, 0, 5, 1, 0, 0, 7, 2, 0, 0, 7, 3, 0, 0, 6}),
                              "<interpolation method='nearest'/>" + outside));
  };
  EXPECT_THAT(faults_of(at("")), ElementsAre("FIELD_OUTSIDE in cell (0) of pattern 'p'"));
  EXPECT_THAT(column(cells_of(at("<outside rule='clamp'/>")), 0), ElementsAre(6));
  EXPECT_THAT(column(cells_of(at("<outside rule='value' value='-1'/>")), 0), ElementsAre(-1));
}

TEST(Sample, ActsAtNodes) {
  const std::string beams =
      "<parameter id='a' value='1'/><beams radius='a'><node id='m' x='0' y='0' z='0'/><node id='n' x='2' y='0' "
      "z='0'/><beam from='m' to='n'/></beams>";
  const std::string grid =
      field("f", 2, "<component name='s'/><regularGrid><axis name='x' start='0' spacing='4' count='2'/></regularGrid>",
            embedded({1, 5}), "<interpolation method='linear'/>");
  const Evaluation evaluation = evaluation_of(pattern_text(
      "<list><place at='1'/></list><sample field='f'/><set parameter='a' value='f.s' at='node'/>", beams, "", grid));
  const CellStream stream = stream_of(evaluation);
  DiagnosticSink sink;
  ASSERT_TRUE(stream.visit(
      0, 1,
      [&](const PlacedCell& c) {
        const auto shape = stream.shape(c, sink);
        if (!shape) return false;
        const auto& strut = std::get<BeamsShape>(shape->value).struts.at(0);
        EXPECT_NEAR(strut.radius_from, 2, 1e-12);
        EXPECT_NEAR(strut.radius_to, 4, 1e-12);
        return true;
      },
      sink))
      << render_all(sink);
}

TEST(Derived, MagnitudeAndPrincipalQuantities) {
  std::string structure = position() + "<component name='u' role='vector'/><component name='v' role='vector'/>";
  for (const char* order : {"xx", "yy", "zz", "xy", "yz", "zx"})
    structure += std::string("<component name='s") + order + "' role='tensor' order='" + order + "'/>";
  const auto value = [&](const std::string& expression) {
    return cells_of(pattern_text("<scatter field='f'/><set parameter='a' value='" + expression + "'/>", cell, "",
                                 field("f", 1, structure + "<points/>", embedded({0, 0, 0, 3, 4, 5, 5, 1, 2, 0, 0}))))
        .at(0)
        .parameters[0];
  };
  EXPECT_EQ(value("f.magnitude"), 5);
  // ((5, 2), (2, 5)) in x and y: 7 along (1, 1), 3 along (-1, 1).
  EXPECT_NEAR(value("f.principal1"), 7, 1e-14);
  EXPECT_NEAR(value("f.principal3"), 1, 1e-14);
  EXPECT_NEAR(value("f.dir1x"), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(value("f.dir2x"), -std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(value("f.vonMises"), std::sqrt((16 + 4 + 36) / 2.0), 1e-14);
}

TEST(Derived, DirectionsOrientCells) {
  std::string structure = position();
  for (const char* order : {"xx", "yy", "zz", "xy", "yz", "zx"})
    structure += std::string("<component name='s") + order + "' role='tensor' order='" + order + "'/>";
  const auto cells =
      cells_of(pattern_text("<scatter field='f'/><orient axis='z' x='f.dir1x' y='f.dir1y' z='f.dir1z' "
                            "signless='true'><second axis='x' x='f.dir2x' y='f.dir2y' z='f.dir2z'/></orient>",
                            cell, "", field("f", 1, structure + "<points/>", embedded({0, 0, 0, 5, 5, 1, 2, 0, 0}))));
  const double h = std::sqrt(0.5);
  expect_near(cells.at(0).world_from_cell.linear * Vec3{0, 0, 1}, {h, h, 0}, 1e-14);
  expect_near(cells.at(0).world_from_cell.linear * Vec3{1, 0, 0}, {-h, h, 0}, 1e-14);
}

/// What check_reach says about pattern "p" against a body of this box.
std::string reach_of(const std::string& instructions, const Box3& body, const std::string& operation = "difference",
                     const MayReach& may_reach = {}, const std::string& places = "<scatter field='f'/>",
                     const std::string& unit_cell = cell) {
  const Evaluation evaluation = evaluation_of(
      "<macrostructures><macrostructure id='m'><csg><box dx='1' dy='1' "
      "dz='1'/></csg></macrostructure></macrostructures>" +
      pattern_text(places + instructions, unit_cell, "", four) +
      "<parts><part id='q' macrostructure='m'><apply pattern='p' operation='" + operation + "'/></part></parts>");
  const Part& part = evaluation.document().parts.items.at(0);
  DiagnosticSink sink;
  const bool good = check_reach(evaluation, stream_of(evaluation), part.steps.at(0), part, body, may_reach, sink);
  EXPECT_EQ(good, !sink.has_errors());
  return sink.diagnostics().empty() ? "" : std::string(info(sink.diagnostics()[0].code).name);
}

// Records stand at x = 0 to 3, cells are balls of radius 1.
TEST(Scatter, CellsReachTheBodyTheyCut) {
  const Box3 near{{3.5, -1, -1}, {9, 1, 1}}, far{{4.5, -1, -1}, {9, 1, 1}};
  EXPECT_EQ(reach_of("", near), "");
  EXPECT_EQ(reach_of("", far), "FIELD_MISSES_PART");
  EXPECT_EQ(reach_of("", far, "intersection"), "FIELD_MISSES_PART");
  EXPECT_EQ(reach_of("", far, "union"), "");
  EXPECT_EQ(reach_of("", Box3{}), "");
  std::size_t asked = 0;
  const auto from = [&](double x) {
    return [&asked, x](const PlacedCell& copy) { return ++asked, copy.world_from_cell.translation.x >= x; };
  };
  const Box3 whole{{-9, -9, -9}, {9, 9, 9}};
  EXPECT_EQ(reach_of("", whole, "difference", from(1)), "");
  EXPECT_EQ(asked, 2U);
  EXPECT_EQ(reach_of("", whole, "difference", from(4)), "FIELD_MISSES_PART");
  EXPECT_EQ(asked, 6U);
  EXPECT_EQ(reach_of("", whole, "union", from(4)), "");
  EXPECT_EQ(reach_of("<when test='f.s &gt; 100'/>", whole, "difference", from(4)), "PATTERN_KEEPS_NONE");
  EXPECT_EQ(reach_of("<translate x='2'/>", far), "");
  EXPECT_EQ(reach_of("<when test='f.s &gt; 5'/>", near), "");
  EXPECT_EQ(reach_of("<when test='f.s &gt; 100'/>", near), "PATTERN_KEEPS_NONE");
  EXPECT_EQ(reach_of("<when test='f.s &gt; 100'/>", far), "PATTERN_KEEPS_NONE");
}

// A part may be meant to stay whole; nobody means it who writes a loop.
TEST(Loops, CellsThatAllMissTheBodyAreTold) {
  const std::string loop = "<loop index='i' axis='x' count='4' spacing='1'/>";
  const Box3 near{{3.5, -1, -1}, {9, 1, 1}}, far{{4.5, -1, -1}, {9, 1, 1}};
  EXPECT_EQ(reach_of("", near, "difference", {}, loop), "");
  EXPECT_EQ(reach_of("", far, "difference", {}, loop), "PATTERN_MISSES_PART");
  EXPECT_EQ(reach_of("", far, "intersection", {}, loop), "");
  EXPECT_EQ(reach_of("", far, "union", {}, loop), "");
  EXPECT_EQ(reach_of("", Box3{}, "difference", {}, loop), "");
  EXPECT_EQ(reach_of("<when test='i &gt; 9'/>", far, "difference", {}, loop), "PATTERN_KEEPS_NONE");
  const std::string none = "<loop index='i' axis='x' count='0' spacing='1'/>";
  EXPECT_EQ(reach_of("", near, "difference", {}, none), "PATTERN_KEEPS_NONE");
  EXPECT_EQ(reach_of("", near, "union", {}, none), "");
}

// A cell of 2 x 3 x 4 mm.
TEST(Loops, BodiesSmallerThanACellAreTold) {
  const std::string loop = "<loop index='i' axis='x' count='4' spacing='2'/>";
  std::string boxed = cell;
  boxed.insert(boxed.find("<csg>"), "<box dx='2' dy='3' dz='4'/>");
  const auto told = [&](double size, const std::string& operation, const std::string& unit_cell) {
    return reach_of("", {{0, 0, 0}, {size, 1, 1}}, operation, {}, loop, unit_cell);
  };
  EXPECT_EQ(told(1.9, "intersection", boxed), "BODY_WITHIN_CELL");
  EXPECT_EQ(told(2.1, "intersection", boxed), "");
  EXPECT_EQ(told(1.9, "difference", boxed), "");
  EXPECT_EQ(told(1.9, "union", boxed), "");
  EXPECT_EQ(told(1.9, "intersection", cell), "");
}

TEST(FieldFaults, OneDiagnosticEach) {
  const auto faults = [](const std::string& structure, const std::vector<double>& values, std::size_t records = 1) {
    return faults_of(pattern_text("<scatter field='f'/>", cell, "", field("f", records, structure, embedded(values))));
  };
  const double nan = std::nan("");
  EXPECT_THAT(faults(position() + "<component name='s'/><points/>", {0, 0, 0, nan}), ElementsAre("FIELD_NOT_FINITE"));
  EXPECT_THAT(faults(position("MPa") + "<points/>", {0, 0, 0}), ElementsAre("FIELD_UNIT"));
  EXPECT_THAT(
      faults(position() +
                 "<component name='u' role='vector' unit='mm'/><component name='v' role='vector' unit='m'/><points/>",
             {0, 0, 0, 1, 2}),
      ElementsAre("FIELD_UNIT"));
}

// Of a position the unit of the file is never dropped: it is stated in the document too, or changes nothing.
TEST(Fields, PositionsInAnotherUnitAreNotTakenForTheDocuments) {
  const std::filesystem::path folder = testing::TempDir() + "meso_field_units";
  std::filesystem::create_directories(folder);
  const auto run = [&](const std::string& heading, const std::string& unit) {
    std::ofstream(folder / "values.csv") << heading << "\n1,2,3\n";
    DiagnosticSink sink;
    auto read = read_document(meso_text(pattern_text("<scatter field='f'/>", cell, "",
                                                     field("f", 1, position(unit) + "<points/>",
                                                           "<external href='values.csv' format='csv'/>"))),
                              (folder / "test.meso").string(), sink);
    auto checked = read ? validate(std::move(read->document), std::move(read->source), folder, sink) : std::nullopt;
    const auto evaluation = checked ? Evaluation::make(*checked, {}, sink) : std::nullopt;
    const auto cells = evaluation ? evaluation->cells(*evaluation->find_pattern("p"), sink) : std::nullopt;
    if (!cells) return render(sink.diagnostics().at(0));
    return format_number(cells_of(*cells).at(0).world_from_cell.translation.x);
  };
  EXPECT_THAT(run("x [m],y [m],z [m]", ""), testing::HasSubstr("FIELD_UNIT"));
  EXPECT_THAT(run("x,y [in],z", ""), testing::HasSubstr("'y' has the unit 'in'; only the file says so"));
  EXPECT_THAT(run("x [deg],y,z", ""), testing::HasSubstr("FIELD_UNIT"));
  EXPECT_EQ(run("x [m],y [m],z [m]", "m"), "1000");
  EXPECT_EQ(run("x [mm],y [mm],z", ""), "1");
  EXPECT_EQ(run("x [node],y,z", ""), "1");
}

TEST(Fields, FilesAreReadCheckedAndMapped) {
  const std::filesystem::path folder = testing::TempDir() + "meso_fields";
  std::filesystem::create_directories(folder);
  const std::vector<double> numbers{-1, 1, 2, 3, 7, 4, 5, 6, 8};
  std::ofstream(folder / "values.raw", std::ios::binary).write(reinterpret_cast<const char*>(numbers.data()), 72);
  std::ofstream(folder / "values.csv") << "s,x [mm],z,y\n7,1,3,2\n8,4,6,5\n";
  const auto run = [&](const std::string& external, const std::string& component = "s") {
    DiagnosticSink sink;
    auto read = read_document(
        meso_text(pattern_text("<scatter field='f'/><set parameter='a' value='f." + component + "'/>", cell, "",
                               field("f", 2,
                                     "<component name='x' role='position' unit='mm'/><component name='y' "
                                     "role='position'/><component name='z' role='position'/><component name='" +
                                         component + "'/><points/>",
                                     external))),
        (folder / "test.meso").string(), sink);
    auto checked = read ? validate(std::move(read->document), std::move(read->source), folder, sink) : std::nullopt;
    const auto evaluation = checked ? Evaluation::make(*checked, {}, sink) : std::nullopt;
    const auto cells = evaluation ? evaluation->cells(*evaluation->find_pattern("p"), sink) : std::nullopt;
    if (!cells) return std::string(info(sink.diagnostics().at(0).code).name);
    const auto copies = cells_of(*cells);
    EXPECT_EQ(copies.at(1).world_from_cell.translation, (Vec3{4, 5, 6}));
    EXPECT_THAT(column(copies, 0), ElementsAre(7, 8));
    return std::string("good");
  };
  EXPECT_EQ(run("<external href='values.raw' format='raw' offset='8'/>"), "good");
  EXPECT_EQ(run("<external href='values.csv' format='csv'/>"), "good");
  EXPECT_EQ(run("<external href='values.csv' format='csv'/>", "t"), "FIELD_COLUMN");
  EXPECT_EQ(run("<external href='values.raw' format='raw' offset='16'/>"), "FIELD_FILE_TRUNCATED");
  EXPECT_EQ(run("<external href='values.raw' format='raw' offset='8' sha256='" + std::string(64, '0') + "'/>"),
            "IMPORT_CHANGED");
  EXPECT_EQ(run("<external href='values.raw' format='frd'/>"), "FIELD_FILE_EMPTY");
}

}  // namespace
}  // namespace meso::eval
