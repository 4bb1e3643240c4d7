// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_msh/read_msh.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "meso/base/vec.hpp"

namespace meso {
namespace {

std::string bytes_of(const std::string& name) {
  std::ifstream in(std::string(MESO_SOURCE_DIR) + "/importers/field_msh/fixtures/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string fault_of(const std::string& bytes, const std::string& view = "") {
  DiagnosticSink sink;
  EXPECT_FALSE(read_field_msh(bytes, "t.msh", view, {}, sink));
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  return sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]);
}

class Msh : public testing::TestWithParam<const char*> {};

// The views were written as functions of the place.
TEST_P(Msh, ValuesAreTheFunctionsThatWereWritten) {
  DiagnosticSink sink;
  const auto table = read_field_msh(bytes_of(GetParam()), GetParam(), "", {}, sink);
  ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
  ASSERT_EQ(table->columns.size(), 7U);
  EXPECT_EQ(table->columns[3].name, "f_value");
  EXPECT_EQ(table->columns[6].name, "v_z");
  ASSERT_GT(table->records.rows(), 20U);
  for (std::size_t r = 0; r < table->records.rows(); ++r) {
    const double x = table->records(r, 0), y = table->records(r, 1), z = table->records(r, 2);
    EXPECT_NEAR(table->records(r, 3), 1 + 2 * x - 3 * y + z / 2, 1e-12);
    EXPECT_NEAR(table->records(r, 5), 2 * y, 1e-12);
  }
}

// The tetrahedra fill the box of volume 2.
TEST_P(Msh, TetrahedraFillTheBox) {
  DiagnosticSink sink;
  const auto table = read_field_msh(bytes_of(GetParam()), GetParam(), "v", {}, sink);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->columns.size(), 6U);
  double volume = 0;
  const auto corner = [&](std::size_t i) {
    const auto r = static_cast<std::size_t>(table->tetra[i]);
    return Vec3{table->records(r, 0), table->records(r, 1), table->records(r, 2)};
  };
  for (std::size_t e = 0; e < table->tetra.size(); e += 4) {
    const Vec3 o = corner(e);
    volume += dot(corner(e + 1) - o, cross(corner(e + 2) - o, corner(e + 3) - o)) / 6;
  }
  EXPECT_NEAR(volume, 2, 1e-9);
}
INSTANTIATE_TEST_SUITE_P(Forms, Msh, testing::Values("box41.msh", "box41_binary.msh", "box22.msh"));

TEST(MshFaults, AreReportedOnce) {
  const std::string good = bytes_of("box41.msh"), binary = bytes_of("box41_binary.msh");
  EXPECT_THAT(fault_of("hello"), testing::HasSubstr("t.msh:1:1: error FIELD_FILE_SYNTAX: expected $MeshFormat"));
  EXPECT_THAT(fault_of(good.substr(0, good.size() / 3)), testing::HasSubstr("FIELD_FILE_"));
  EXPECT_THAT(fault_of(binary.substr(0, binary.size() / 3)), testing::HasSubstr("FIELD_FILE_TRUNCATED"));
  EXPECT_THAT(fault_of(good, "g"), testing::HasSubstr("no view 'g'"));
  EXPECT_THAT(fault_of("$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"), testing::HasSubstr("FIELD_FILE_UNSUPPORTED"));
  EXPECT_THAT(fault_of("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 zero\n"),
              testing::HasSubstr("t.msh:6:7: error FIELD_FILE_SYNTAX: expected a number, found 'zero'"));
}

TEST(MshNodes, MayStandBehindValues) {
  DiagnosticSink sink;
  const auto table = read_field_msh(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$NodeData\n1\n\"t\"\n1\n0\n3\n0\n1\n0\n$EndNodeData\n"
      "$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n",
      "t.msh", "", {}, sink);
  ASSERT_TRUE(table);
  ASSERT_EQ(table->records.rows(), 2U);
  EXPECT_TRUE(std::isnan(table->records(0, 3)) && std::isnan(table->records(1, 3)));
}

}  // namespace
}  // namespace meso
