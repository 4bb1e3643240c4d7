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
  MeasuredMeshSink<float> measured(into);
  ASSERT_TRUE(write_mesh(cubes, measured));
  EXPECT_EQ(kept.points, cubes.points);
  EXPECT_EQ(kept.triangles, cubes.triangles);
  const MeshMeasures m = measured.measures(0);
  EXPECT_DOUBLE_EQ(m.volume, 9);
  EXPECT_DOUBLE_EQ(m.area, 30);
  EXPECT_EQ(m.points, 16u);
  EXPECT_EQ(m.triangles, 24u);
  EXPECT_EQ(m.components, 2u);
  EXPECT_EQ(m.euler, 4);
  EXPECT_TRUE(m.closed);
  EXPECT_EQ(m.box, (Box3{{-5, 0, 0}, {3, 4, 5}}));
}

TEST(MeasuredMeshSink, MeasuresWhatIsWritten) {
  // A float near 1e8 is a multiple of 8.
  TriangleMesh cube, kept;
  add_cube(cube, {1e8 + 1, 0, 0}, 1.25);
  MemoryMeshSink into(kept);
  MeasuredMeshSink<double> doubles(into);
  MeasuredMeshSink<float> floats(into);
  ASSERT_TRUE(write_mesh(cube, doubles) && write_mesh(cube, floats));
  EXPECT_NEAR(doubles.measures(0).volume, 1.25 * 1.25 * 1.25, 1e-6);
  EXPECT_EQ(doubles.measures(0).box.min.x, 1e8 + 1);
  EXPECT_EQ(floats.measures(0).volume, 0);
}

TEST(MeasuredMeshSink, TellsPiecesFromCavitiesAndCrumbs) {
  TriangleMesh mesh, hole, kept;
  add_cube(mesh, {1e3, 0, 0}, 4);
  add_cube(mesh, {1e3 + 8, 0, 0}, 2);
  add_cube(mesh, {1e3 + 16, 0, 0}, 0.0625);
  add_cube(hole, {1e3 + 1, 1, 1}, 1);
  for (auto& t : hole.triangles) std::swap(t[1], t[2]);
  const auto base = static_cast<std::uint32_t>(mesh.points.size());
  for (const auto& t : hole.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  mesh.points.insert(mesh.points.end(), hole.points.begin(), hole.points.end());
  MemoryMeshSink into(kept);
  MeasuredMeshSink<float> measured(into);
  ASSERT_TRUE(write_mesh(mesh, measured));
  const MeshMeasures all = measured.measures(0), large = measured.measures(0.001);
  EXPECT_EQ(all.components, 3u);
  EXPECT_EQ(all.cavities, 1u);
  EXPECT_EQ(all.crumbs, 0u);
  EXPECT_EQ(large.components, 2u);
  EXPECT_EQ(large.cavities, 1u);
  EXPECT_EQ(large.crumbs, 1u);
  EXPECT_NEAR(all.volume, 64 + 8 - 1 + 0.0625 * 0.0625 * 0.0625, 1e-9);
}

TEST(MeasuredMeshSink, ReadsJoinedBlocks) {
  TriangleMesh cube, kept;
  add_cube(cube, {0, 0, 0}, 1);
  MemoryMeshSink into(kept);
  MeasuredMeshSink<float> measured(into);
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
  EXPECT_DOUBLE_EQ(measured.measures(0).volume, 1);
  EXPECT_EQ(measured.measures(0).components, 1u);
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
    MeasuredMeshSink<float> measured(into);
    ASSERT_TRUE(write_mesh(cube, measured));
    EXPECT_FALSE(measured.measures(0).closed);
  }
}

TEST(MeasuredMeshSink, AnEmptyMeshIsClosed) {
  TriangleMesh none, kept;
  MemoryMeshSink into(kept);
  MeasuredMeshSink<float> measured(into);
  ASSERT_TRUE(write_mesh(none, measured));
  EXPECT_TRUE(measured.measures(0).closed);
  EXPECT_EQ(measured.measures(0).components, 0u);
  EXPECT_TRUE(measured.measures(0).box.empty());
}

}  // namespace
}  // namespace meso::operations
