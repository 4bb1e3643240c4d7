// SPDX-License-Identifier: Apache-2.0
// Every fixture holds one tetrahedron and one hexahedron (or a grid), s = 1 + 2x - 3y + z / 2 and v = (x, 2y, 3z).
#include "meso/import_field_vtk/read_vtk.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace meso {
namespace {

std::string bytes_of(const std::string& name) {
  std::ifstream in(std::string(MESO_SOURCE_DIR) + "/importers/field_vtk/fixtures/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::optional<fields::Table> read(const std::string& bytes, const std::string& name, const std::string& array,
                                  DiagnosticSink& sink) {
  return name.ends_with(".vtu") ? read_field_vtu(bytes, name, array, {}, sink)
                                : read_field_vtk(bytes, name, array, {}, sink);
}
std::string fault_of(const std::string& bytes, const std::string& name, const std::string& array = "") {
  DiagnosticSink sink;
  EXPECT_FALSE(read(bytes, name, array, sink)) << name;
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  return sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]);
}
void expect_functions(const fields::Table& table) {
  ASSERT_EQ(table.columns.size(), 7U);
  EXPECT_EQ(table.columns[3].name, "s");
  EXPECT_EQ(table.columns[5].name, "v_y");
  for (std::size_t r = 0; r < table.records.rows(); ++r) {
    const double x = table.records(r, 0), y = table.records(r, 1), z = table.records(r, 2);
    EXPECT_EQ(table.records(r, 3), 1 + 2 * x - 3 * y + z / 2);
    EXPECT_EQ(table.records(r, 6), 3 * z);
  }
}

class VtkMesh : public testing::TestWithParam<const char*> {};
TEST_P(VtkMesh, HasPointsCellsAndArrays) {
  DiagnosticSink sink;
  const auto table = read(bytes_of(GetParam()), GetParam(), "", sink);
  ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
  EXPECT_EQ(table->records.rows(), 12U);
  expect_functions(*table);
  EXPECT_THAT(table->tetra, testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(table->hexa, testing::ElementsAre(4, 5, 6, 7, 8, 9, 10, 11));
}
TEST_P(VtkMesh, SaysOnceThatItDoesNotFitIntoMemory) {
  const std::string name = GetParam(), bytes = bytes_of(name);
  const RunOptions run{.max_memory_bytes = 1500};
  DiagnosticSink sink;
  EXPECT_FALSE(name.ends_with(".vtu") ? read_field_vtu(bytes, name, "", run, sink)
                                      : read_field_vtk(bytes, name, "", run, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::limit_memory);
}
INSTANTIATE_TEST_SUITE_P(Forms, VtkMesh,
                         testing::Values("mesh_v42.vtk", "mesh_v42_binary.vtk", "mesh_v51.vtk", "mesh_v51_binary.vtk",
                                         "mesh_ascii.vtu", "mesh_base64.vtu", "mesh_zlib.vtu", "mesh_appended.vtu",
                                         "mesh_appended_raw.vtu"));

TEST(VtkGrid, RowsRunXFastest) {
  DiagnosticSink sink;
  for (const char* name : {"points.vtk", "rectilinear.vtk"}) {
    const auto table = read(bytes_of(name), name, "", sink);
    ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
    expect_functions(*table);
    EXPECT_EQ(table->is_regular, std::string(name) == "points.vtk");
    EXPECT_THAT(table->grid[0], testing::ElementsAre(1, 1.5, 2));
    EXPECT_THAT(table->grid[1], testing::ElementsAre(0, 2));
    EXPECT_EQ(table->records(1, 0), 1.5);
    EXPECT_EQ(table->records(3, 1), 2);
  }
}

TEST(VtkFaults, AreReportedOnce) {
  const std::string text = bytes_of("mesh_v42.vtk"), binary = bytes_of("mesh_v51_binary.vtk"),
                    zlib = bytes_of("mesh_zlib.vtu"), raw = bytes_of("mesh_appended_raw.vtu");
  EXPECT_THAT(fault_of("solid x", "t.vtk"), testing::HasSubstr("t.vtk:1:1: error FIELD_FILE_SYNTAX"));
  EXPECT_THAT(fault_of(text.substr(0, text.size() - 30), "t.vtk"), testing::HasSubstr("FIELD_FILE_TRUNCATED"));
  EXPECT_THAT(fault_of(binary.substr(0, 300), "t.vtk"), testing::HasSubstr("FIELD_FILE_TRUNCATED"));
  const std::string grid = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS ";
  EXPECT_THAT(fault_of(grid + "17179869184 17179869184 1\nPOINT_DATA 1\n", "t.vtk"),
              testing::HasSubstr("expected data for every point"));
  EXPECT_THAT(fault_of(text, "t.vtk", "stress"), testing::HasSubstr("no array 'stress'"));
  EXPECT_THAT(fault_of(zlib.substr(0, zlib.size() / 2), "t.vtu"), testing::HasSubstr("well-formed XML"));
  EXPECT_THAT(fault_of(raw.substr(0, raw.size() - 100), "t.vtu"),
              testing::HasSubstr("fewer bytes than its header states"));
  std::string damaged = zlib;
  const std::size_t at = damaged.find("Name=\"s\"");
  const std::size_t data = damaged.find("eJ", at);
  ASSERT_NE(data, std::string::npos);
  damaged.replace(data + 4, 4, "AAAA");
  EXPECT_THAT(fault_of(damaged, "t.vtu"), testing::HasSubstr("damaged blocks"));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(VtkFaults, NumbersThatLieAreFound) {
  const std::string cell =
      "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
      "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n"
      "POINT_DATA 4\nSCALARS s double\nLOOKUP_TABLE default\n1 2 3 4\n";
  DiagnosticSink sink;
  ASSERT_TRUE(read(cell, "t.vtk", "", sink));
  for (const char* offsets : {"4000000000 -9223372036854775808", "9223372036854775807 -9", "2 4", "-4 0", "4 0"})
    EXPECT_THAT(fault_of(replaced(cell, "\n0 4\n", std::string("\n") + offsets + "\n"), "t.vtk"),
                testing::HasSubstr("cells with enough points"));
  // 2^62 numbers for each of four points are none, modulo 2^64.
  const std::string array =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points><DataArray type=\"Float64\" "
      "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><PointData><DataArray type=\"Float64\" "
      "Name=\"s\" NumberOfComponents=\"4611686018427387904\" format=\"ascii\"/></PointData></Piece>"
      "</UnstructuredGrid></VTKFile>";
  EXPECT_THAT(fault_of(array, "t.vtu"), testing::HasSubstr("4611686018427387904 numbers for each point"));
  // Two packed blocks whose sizes add up to 0, modulo 2^64.
  const std::uint64_t header[] = {2, 8, 8, ~std::uint64_t{0} - 9, 10};
  const std::string packed =
      "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
      "<UnstructuredGrid><Piece><Points><DataArray type=\"Float64\" format=\"appended\" offset=\"0\"/></Points>"
      "</Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" +
      std::string(reinterpret_cast<const char*>(header), sizeof header) + "</AppendedData></VTKFile>";
  EXPECT_THAT(fault_of(packed, "t.vtu"), testing::HasSubstr("fewer bytes than its header states"));
}

}  // namespace
}  // namespace meso
