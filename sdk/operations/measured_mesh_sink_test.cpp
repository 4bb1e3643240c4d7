// SPDX-License-Identifier: Apache-2.0
#include "measured_mesh_sink.hpp"

#include <gtest/gtest.h>

#include "meso/base/memory_mesh_sink.hpp"

namespace meso::operations {
namespace {

void add_cube(TriangleMesh& mesh, Vec3 at, double size) {
  const auto base = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t i = 0; i < 8; ++i)
    mesh.points.push_back(at + size * Vec3{double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  for (const auto& [a, b, c, d] : std::initializer_list<std::array<std::uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({base + a, base + b, base + c});
    mesh.triangles.push_back({base + a, base + c, base + d});
  }
}

TEST(MeasuredMeshSink, MeasuresWhatItPassesOn) {
  TriangleMesh cubes, kept;
  add_cube(cubes, {1, 2, 3}, 2);
  add_cube(cubes, {-5, 0, 0}, 1);
  MemoryMeshSink into(kept);
  MeasuredMeshSink measured(into);
  ASSERT_TRUE(write_mesh(cubes, measured));
  EXPECT_EQ(kept.points, cubes.points);
  EXPECT_EQ(kept.triangles, cubes.triangles);
  const MeshMeasures m = measured.measures();
  EXPECT_DOUBLE_EQ(m.volume, 9);
  EXPECT_DOUBLE_EQ(m.area, 30);
  EXPECT_EQ(m.points, 16u);
  EXPECT_EQ(m.triangles, 24u);
  EXPECT_EQ(m.components, 2u);
  EXPECT_EQ(m.euler, 4);
  EXPECT_TRUE(m.closed);
  EXPECT_EQ(m.box, (Box3{{-5, 0, 0}, {3, 4, 5}}));
}

TEST(MeasuredMeshSink, ReadsJoinedBlocks) {
  TriangleMesh cube, kept;
  add_cube(cube, {0, 0, 0}, 1);
  MemoryMeshSink into(kept);
  MeasuredMeshSink measured(into);
  ASSERT_TRUE(measured.begin());
  ByteBuffer bytes;
  measured.encode_points(std::span(cube.points).first(3), bytes);
  measured.encode_points(std::span(cube.points).subspan(3), bytes);
  ASSERT_TRUE(measured.write_points(bytes.view()));
  ASSERT_TRUE(measured.begin_triangles(8));
  bytes.clear();
  measured.encode_triangles(std::span(cube.triangles).first(5), bytes);
  measured.encode_triangles(std::span(cube.triangles).subspan(5), bytes);
  ASSERT_TRUE(measured.write_triangles(bytes.view()));
  ASSERT_TRUE(measured.finish(12));
  EXPECT_EQ(kept.triangles, cube.triangles);
  EXPECT_DOUBLE_EQ(measured.measures().volume, 1);
  EXPECT_EQ(measured.measures().components, 1u);
}

TEST(MeasuredMeshSink, SeesHolesAndTurnedTriangles) {
  for (const bool turned : {false, true}) {
    TriangleMesh cube, kept;
    add_cube(cube, {0, 0, 0}, 1);
    if (turned) {
      std::swap(cube.triangles[3][0], cube.triangles[3][1]);
    } else {
      cube.triangles.pop_back();
    }
    MemoryMeshSink into(kept);
    MeasuredMeshSink measured(into);
    ASSERT_TRUE(write_mesh(cube, measured));
    EXPECT_FALSE(measured.measures().closed);
  }
}

TEST(MeasuredMeshSink, AnEmptyMeshIsClosed) {
  TriangleMesh none, kept;
  MemoryMeshSink into(kept);
  MeasuredMeshSink measured(into);
  ASSERT_TRUE(write_mesh(none, measured));
  EXPECT_TRUE(measured.measures().closed);
  EXPECT_EQ(measured.measures().components, 0u);
  EXPECT_TRUE(measured.measures().box.empty());
}

}  // namespace
}  // namespace meso::operations
