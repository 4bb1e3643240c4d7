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

TEST_P(WriteStl, RangesGiveTheBytesOfTheStream) {
  TriangleMesh many;
  for (int i = 0; i < 50; ++i) {
    const TriangleMesh one = wedge(i % 5 == 0 ? 1e-9 : 0.25, {1.0 + i, 0.5 * i, 1000});
    const auto first = static_cast<std::uint32_t>(many.points.size());
    many.points.insert(many.points.end(), one.points.begin(), one.points.end());
    for (const auto& t : one.triangles) many.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const std::string stream = stl(many, GetParam());
  for (const std::size_t each : {1u, 7u, 1000u}) {
    const TriangleRanges ranges{
        (many.triangles.size() + each - 1) / each, [&](std::size_t range, const TriangleBlockCallback& callback) {
          TriangleMesh part{many.points, {}};
          for (std::size_t t = range * each; t < std::min(many.triangles.size(), (range + 1) * each); ++t)
            part.triangles.push_back(many.triangles[t]);
          triangles_of(part)(callback);
        }};
    for (const unsigned jobs : {1u, 2u, 5u}) {
      StringSink sink;
      const StlCounts counts = write_stl(ranges, GetParam(), sink, jobs);
      EXPECT_TRUE(counts.complete);
      EXPECT_TRUE(sink.text() == stream) << each << " a range, " << jobs << " jobs";
      EXPECT_EQ(counts.bytes, stream.size());
      EXPECT_EQ(counts.left_out, 20u);
    }
  }
}

TEST_P(WriteStl, AFullDiskEndsAllThreads) {
  struct FullDisk final : ByteSink {
    bool write(std::string_view) override { return ++writes <= 2; }
    int writes = 0;
  };
  const TriangleMesh mesh = wedge(0.25, {});
  const TriangleRanges ranges{
      40, [&](std::size_t, const TriangleBlockCallback& callback) { triangles_of(mesh)(callback); }};
  for (const unsigned jobs : {1u, 3u}) {
    FullDisk disk;
    EXPECT_FALSE(write_stl(ranges, GetParam(), disk, jobs).complete);
    EXPECT_EQ(disk.writes, 3);
  }
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
