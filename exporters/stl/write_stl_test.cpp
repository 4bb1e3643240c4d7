// SPDX-License-Identifier: Apache-2.0
#include "meso/export_stl/write_stl.hpp"

#include <gtest/gtest.h>

#include "meso/import_surface_mesh/read_stl.hpp"
#include "meso/mesh/audit_mesh.hpp"

namespace meso {
namespace {

// A box fan with one short edge: its two ends are one float apart at most, far from the origin.
TriangleMesh wedge(double short_edge, Vec3 at) {
  const Vec3 a = at, b = at + Vec3{1, 0, 0}, c = at + Vec3{0, 1, 0}, top = at + Vec3{0, 0, 1},
             near_top = at + Vec3{short_edge, 0, 1};
  return {{a, b, c, top, near_top}, {{0, 2, 1}, {0, 1, 4}, {0, 4, 3}, {0, 3, 2}, {3, 4, 2}, {1, 2, 4}}};
}

std::string stl(const TriangleMesh& mesh, StlFormat format) {
  StringSink sink;
  const StlCounts counts = write_stl(triangles_of(mesh), format, sink);
  EXPECT_TRUE(counts.complete);
  EXPECT_EQ(counts.bytes, sink.text().size());
  EXPECT_EQ(counts.triangles + counts.left_out, mesh.triangles.size());
  return sink.text();
}

class WriteStl : public testing::TestWithParam<StlFormat> {};
INSTANTIATE_TEST_SUITE_P(Formats, WriteStl, testing::Values(StlFormat::ascii, StlFormat::binary),
                         [](const auto& test) { return test.param == StlFormat::ascii ? "ascii" : "binary"; });

TEST_P(WriteStl, ReadsBackWatertight) {
  DiagnosticSink sink;
  const auto mesh = read_stl(stl(wedge(0.25, {0.1, -0.2, 0.3}), GetParam()), "f.stl", sink);
  ASSERT_TRUE(mesh);
  const MeshAudit audit = audit_mesh(*mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.triangles, 6u);
  EXPECT_NEAR(audit.volume, audit_mesh(wedge(0.25, {})).volume, 1e-6);
}

TEST_P(WriteStl, StaysWatertightWhereRoundingFoldsTriangles) {
  DiagnosticSink sink;
  const auto mesh = read_stl(stl(wedge(1e-4, {1e5, 1e5, 1e5}), GetParam()), "f.stl", sink);
  ASSERT_TRUE(mesh);
  const MeshAudit audit = audit_mesh(*mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.triangles, 4u);
  EXPECT_EQ(audit.points, 4u);
}

TEST(WriteStlAscii, LooksLikeStl) {
  const TriangleMesh one{{{0, 0, -0.0}, {2, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(
      stl(one, StlFormat::ascii),
      "solid meso\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 0.1 0\nendloop\nendfacet\n"
      "endsolid meso\n");
}

TEST(WriteStlBinary, CountsBeforeTheTriangles) {
  const std::string bytes = stl(wedge(0.25, {}), StlFormat::binary);
  EXPECT_EQ(bytes.size(), 84u + 6 * 50);
  EXPECT_EQ(bytes[80], 6);
  EXPECT_FALSE(bytes.starts_with("solid"));
}

}  // namespace
}  // namespace meso
