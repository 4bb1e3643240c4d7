// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/field_import.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "meso/eval/evaluation.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso::operations {
namespace {

std::string fixture(const std::string& name) { return std::string(MESO_SOURCE_DIR) + "/importers/" + name; }
std::string text_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Cells of a pattern that samples the field of a document at its own records, and the parameter that each has.
std::vector<std::pair<Vec3, double>> sampled(const std::string& file, const std::string& id,
                                             const std::string& expression) {
  std::string text = text_of(file);
  text.replace(
      text.find("</meso>"), 7,
      "<unitCells><unitCell id='c'><parameter id='a' value='0'/><csg><sphere radius='1'/></csg></unitCell></unitCells>"
      "<patterns><pattern id='p' unitCell='c'><scatter field='" +
          id + "'/><sample field='" + id + "'/><set parameter='a' value='" + expression +
          "'/></pattern></patterns></meso>");
  DiagnosticSink sink;
  auto read = read_document(text, "t.meso", sink);
  auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  const auto evaluation = checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
  const auto cells = evaluation ? evaluation->cells(*evaluation->find_pattern("p"), sink) : std::nullopt;
  std::vector<std::pair<Vec3, double>> result;
  if (cells)
    (void)cells->visit(
        0, cells->size(),
        [&](const eval::PlacedCell& c) {
          result.emplace_back(c.global, c.parameters[0]);
          return true;
        },
        sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return result;
}

double written(Vec3 p) { return 1 + 2 * p.x - 3 * p.y + p.z / 2; }  // what the fixtures' scripts say

TEST(ImportField, AMeshBecomesADocumentThatEvaluates) {
  const std::string out = testing::TempDir() + "box.meso";
  DiagnosticSink sink;
  const auto report = import_field(fixture("field_msh/fixtures/box41.msh"), out, {}, sink);
  ASSERT_TRUE(report) << render(sink.diagnostics().at(0));
  EXPECT_EQ(report->box, (Box3{{0, 0, 0}, {2, 1, 1}}));
  const auto cells = sampled(out, "box", "box.f_value");
  EXPECT_EQ(cells.size(), report->records);
  for (const auto& [p, value] : cells) EXPECT_NEAR(value, written(p), 1e-9);
}

TEST(ImportField, AGridBecomesADocumentThatEvaluates) {
  for (const char* name : {"points.vtk", "rectilinear.vtk"}) {
    const std::string out = testing::TempDir() + "grid.meso";
    DiagnosticSink sink;
    ASSERT_TRUE(import_field(fixture(std::string("field_vtk/fixtures/") + name), out, {.unit = "cm"}, sink));
    const auto cells = sampled(out, "grid", "grid.s");
    EXPECT_EQ(cells.size(), 12U);
    for (const auto& [p, value] : cells) EXPECT_NEAR(value, written(p / 10), 1e-12);
  }
}

TEST(ImportField, TensorsAndVectorsAreRecognised) {
  const std::string out = testing::TempDir() + "cube.meso";
  DiagnosticSink sink;
  ASSERT_TRUE(import_field(fixture("field_frd/fixtures/cube.frd"), out, {}, sink));
  const std::string text = text_of(out);
  EXPECT_THAT(text, testing::HasSubstr("<component name=\"SZX\" role=\"tensor\" order=\"zx\"/>"));
  EXPECT_THAT(text, testing::HasSubstr("<component name=\"D2\" role=\"vector\"/>"));
  EXPECT_EQ(sampled(out, "cube", "cube.principal1 + cube.magnitude").size(), 9U);
}

TEST(ImportField, WritesNothingForNumbersThatAreNone) {
  const std::string in = testing::TempDir() + "nan.csv", out = testing::TempDir() + "nan.meso";
  std::ofstream(in) << "x,y,z,s\n0,0,0,1\n1,0,0,nan\n2,0,0,inf\n";
  DiagnosticSink sink;
  EXPECT_FALSE(import_field(in, out, {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_THAT(render(sink.diagnostics()[0]),
              testing::HasSubstr(
                  "component 's' of the field 'nan.csv' is no finite number in 2 of 3 records, first in record 1"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto info = field_info(in, {}, sink);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->columns.at(3).statistics.nan, 1U);
}

TEST(ImportField, AMeshOfTwoKindsBecomesOneOfTetrahedra) {
  const std::string in = testing::TempDir() + "mixed.vtk", out = testing::TempDir() + "mixed.meso";
  // A cube whose lowest record is not its first corner, and a tetrahedron on it; s = 1 + 2x - 3y + z/2.
  std::ofstream(in) << "# vtk DataFile Version 2.0\nmixed\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n"
                       "1 1 1 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1 1 1 2\nCELLS 2 14\n"
                       "8 1 2 3 4 5 6 0 7\n4 5 6 0 8\nCELL_TYPES 2\n12 10\nPOINT_DATA 9\nSCALARS s double 1\n"
                       "LOOKUP_TABLE default\n0.5 1 3 0 -2 1.5 3.5 -1.5 1\n";
  DiagnosticSink sink;
  ASSERT_TRUE(import_field(in, out, {}, sink));
  std::string text = text_of(out);
  EXPECT_THAT(text, testing::HasSubstr("elements=\"7\""));
  const std::string list =
      "<unitCells><unitCell id='c'><parameter id='a' value='0'/><csg><sphere radius='1'/></csg></unitCell></unitCells>"
      "<patterns><pattern id='p' unitCell='c'><loop index='i' axis='x' count='5' start='0.1' spacing='0.2'/><loop "
      "index='j' axis='y' count='5' start='0.1' spacing='0.2'/><loop index='k' axis='z' count='5' start='0.1' "
      "spacing='0.2'/><sample field='mixed'/><set parameter='a' value='mixed.s'/></pattern></patterns></meso>";
  text.replace(text.find("</meso>"), 7, list);
  auto read = read_document(text, "t.meso", sink);
  auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  const auto evaluation = checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
  const auto cells = evaluation ? evaluation->cells(*evaluation->find_pattern("p"), sink) : std::nullopt;
  ASSERT_TRUE(cells) << render(sink.diagnostics().at(0));
  std::size_t count = 0;
  EXPECT_TRUE(cells->visit(
      0, cells->size(),
      [&](const eval::PlacedCell& c) {
        EXPECT_NEAR(c.parameters[0], written(c.global), 1e-12);
        return ++count > 0;
      },
      sink));
  EXPECT_EQ(count, 125U) << "the six leave no gap in the cube";
}

}  // namespace
}  // namespace meso::operations
