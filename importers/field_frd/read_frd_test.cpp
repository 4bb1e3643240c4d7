// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_frd/read_frd.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace meso {
namespace {

std::string bytes_of(const std::string& name) {
  std::ifstream in(std::string(MESO_SOURCE_DIR) + "/importers/field_frd/fixtures/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string names_of(const fields::Table& table) {
  std::string names;
  for (const fields::Column& c : table.columns) names += (names.empty() ? "" : " ") + c.name;
  return names;
}
std::string fault_of(const std::string& bytes, const std::string& data_set = "") {
  DiagnosticSink sink;
  EXPECT_FALSE(read_field_frd(bytes, "t.frd", data_set, {}, sink));
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  return sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]);
}

// Node 10, the cube's middle, as a person reads it in the text.
TEST(Frd, ReadsNodesElementsAndResults) {
  DiagnosticSink sink;
  const auto table = read_field_frd(bytes_of("cube.frd"), "cube.frd", "", {}, sink);
  ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
  EXPECT_EQ(names_of(*table), "x y z D1 D2 D3 SXX SYY SZZ SXY SYZ SZX STR___");
  ASSERT_EQ(table->records.rows(), 9U);
  EXPECT_EQ(table->records(8, 0), 0.5);
  EXPECT_EQ(table->records(8, 4), -4.86332e-05);
  EXPECT_EQ(table->tetra.size(), 48U);
  EXPECT_EQ(table->tetra[3], 8);  // node 10 is row 8
}

// The text has six digits, the binary form floats: two writers of one result.
TEST(Frd, BinaryAndTextAgree) {
  DiagnosticSink sink;
  const auto text = read_field_frd(bytes_of("cube.frd"), "cube.frd", "STRESS", {}, sink);
  const auto binary = read_field_frd(bytes_of("cube_binary.frd"), "cube_binary.frd", "STRESS", {}, sink);
  ASSERT_TRUE(text && binary);
  EXPECT_EQ(names_of(*binary), "x y z SXX SYY SZZ SXY SYZ SZX");
  EXPECT_EQ(binary->tetra, text->tetra);
  for (std::size_t r = 0; r < 9; ++r) {
    for (std::size_t c = 0; c < 9; ++c)
      EXPECT_NEAR((*binary).records(r, c), text->records(r, c), 1e-5 * std::abs(text->records(r, c)) + 1e-12);
  }
}

// The forces on the free nodes are (5, 0, -30): what the clamped side carries is their opposite. With linear tetrahedra
// the mean of SZZ over the elements' corners is no exact measure, its sign is.
TEST(Frd, StressesPointTheRightWay) {
  DiagnosticSink sink;
  const auto table = read_field_frd(bytes_of("cube.frd"), "cube.frd", "", {}, sink);
  ASSERT_TRUE(table);
  EXPECT_LT(table->records(8, 8), 0);  // SZZ: pressed
}

TEST(Frd, SaysWhereItIsWrong) {
  const std::string good = bytes_of("cube.frd"), binary = bytes_of("cube_binary.frd");
  EXPECT_THAT(fault_of(good.substr(0, 900)), testing::HasSubstr("FIELD_FILE_"));
  EXPECT_THAT(fault_of(binary.substr(0, binary.size() - 200)), testing::HasSubstr("FIELD_FILE_TRUNCATED"));
  EXPECT_THAT(fault_of(good, "TEMP"), testing::HasSubstr("no data set 'TEMP'"));
  EXPECT_THAT(fault_of("    1C\n 9999\n"), testing::HasSubstr("no nodes"));
  std::string wrong = good;
  wrong.replace(wrong.find("5.00000E-01"), 5, "5.x00");
  EXPECT_THAT(fault_of(wrong),
              testing::HasSubstr("t.frd:15:1: error FIELD_FILE_SYNTAX: expected numbers in columns of 12"));
}

TEST(Frd, NodesMayStandBehindResults) {
  std::string text = bytes_of("cube.frd");
  std::string head = "    2C", node = " -1       100 1.00000E+00 2.00000E+00 3.00000E+00\n -3\n";
  head.resize(35, ' ');
  head += '1';
  head.resize(74, ' ');
  text.insert(text.rfind(" 9999"), head + "1\n" + node);
  DiagnosticSink sink;
  const auto table = read_field_frd(text, "t.frd", "STRESS", {}, sink);
  ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
  ASSERT_EQ(table->records.rows(), 10U);
  EXPECT_EQ(table->records(9, 2), 3);
  EXPECT_TRUE(std::isnan(table->records(9, 3)));
}

}  // namespace
}  // namespace meso
