// SPDX-License-Identifier: Apache-2.0
#include "meso/export_tetra_mesh/write_tet_mesh.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace meso {
namespace {

/// Two tetrahedra on the plane z = 0, one face between them.
TetMesh pair() {
  using Side = TetMesh::Side;
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  mesh.boundary = {{0, 3, Side::x_min},   {0, 1, Side::y_min},   {0, 0, Side::z_min},
                   {1, 1, Side::surface}, {1, 2, Side::surface}, {1, 3, Side::surface}};
  return mesh;
}

std::string written(const TetMesh& mesh, TetFormat format) {
  StringSink bytes;
  DiagnosticSink sink;
  EXPECT_TRUE(write_tet_mesh(mesh, format, bytes, {}, sink));
  return bytes.text();
}

template <class Value>
Value at(const std::string& bytes, std::size_t offset) {
  Value v;
  std::memcpy(&v, bytes.data() + offset, sizeof v);
  return v;
}

TEST(WriteTetMesh, FacesOfTheTestFaceOutward) {
  const TetMesh mesh = pair();
  for (const TetMesh::Face& f : mesh.boundary) {
    const auto c = mesh.corners(f);
    Vec3 centre;
    for (const std::uint32_t p : mesh.tets[f.tet]) centre += mesh.points[p] / 4;
    const Vec3 a = mesh.points[c[0]], normal = cross(mesh.points[c[1]] - a, mesh.points[c[2]] - a);
    EXPECT_GT(dot(normal, a - centre), 0) << f.tet << ' ' << int(f.face);
  }
}

TEST(WriteTetMesh, InpHasNodesElementsAndSetsOfSides) {
  EXPECT_EQ(written(pair(), TetFormat::inp), R"(** tetrahedra in millimetres, written by meso
*NODE, NSET=ALL
1,0,0,0
2,1,0,0
3,0,1,0
4,0,0,1
5,0.1,1,1
*ELEMENT, TYPE=C3D4, ELSET=SOLID
1,1,2,3,4
2,2,3,4,5
*NSET, NSET=X_MIN
1,3,4
*ELSET, ELSET=X_MIN
1
*SURFACE, NAME=S_X_MIN, TYPE=ELEMENT
1, S4
*NSET, NSET=Y_MIN
1,2,4
*ELSET, ELSET=Y_MIN
1
*SURFACE, NAME=S_Y_MIN, TYPE=ELEMENT
1, S2
*NSET, NSET=Z_MIN
1,2,3
*ELSET, ELSET=Z_MIN
1
*SURFACE, NAME=S_Z_MIN, TYPE=ELEMENT
1, S1
*NSET, NSET=SURFACE
2,3,4,5
*ELSET, ELSET=SURFACE
2
*SURFACE, NAME=S_SURFACE, TYPE=ELEMENT
2, S2
2, S3
2, S4
)");
}

TEST(WriteTetMesh, InpHasNoNumberOfMoreThanTwentyCharacters) {
  TetMesh mesh = pair();
  mesh.points[4] = {-1e-5 / 3, 2e-105 / 3, -0.0002 / 3};
  EXPECT_NE(written(mesh, TetFormat::inp).find("\n5,-3.333333333333e-06,6.666666666667e-106,-6.666666666667e-05\n"),
            std::string::npos);
}

TEST(WriteTetMesh, SetsBreakLinesAfterSixteenNumbers) {
  TetMesh mesh;
  for (std::uint32_t i = 0; i < 20; ++i) {
    mesh.points.insert(mesh.points.end(), {{double(i), 0, 0}, {i + 0.5, 1, 0}, {i + 0.2, 0, 1}, {i + 0.1, 0.1, 0.1}});
    mesh.tets.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    mesh.boundary.push_back({i, 0, TetMesh::Side::z_max});
  }
  const std::string text = written(mesh, TetFormat::inp);
  EXPECT_NE(text.find("*ELSET, ELSET=Z_MAX\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n17,18,19,20\n"), text.npos);
}

TEST(WriteTetMesh, VtuArraysAreWhereTheHeaderSays) {
  const TetMesh mesh = pair();
  const std::string bytes = written(mesh, TetFormat::vtu);
  const auto data = [&](const std::string& name) {
    const std::size_t element = bytes.find("Name=\"" + name + "\"");
    const std::size_t offset = bytes.find("offset=\"", element) + 8;
    return bytes.find("encoding=\"raw\">\n_") + 17 + std::stoul(bytes.substr(offset));
  };
  EXPECT_EQ(at<std::uint64_t>(bytes, data("points")), 5 * 24u);
  EXPECT_EQ(at<double>(bytes, data("points") + 8 + 4 * 24), 0.1);
  EXPECT_EQ(at<std::uint64_t>(bytes, data("connectivity")), 2 * 16u);
  EXPECT_EQ(at<std::uint32_t>(bytes, data("connectivity") + 8 + 7 * 4), 4u);
  EXPECT_EQ(at<std::uint64_t>(bytes, data("offsets") + 8 + 8), 8u);
  EXPECT_EQ(at<std::uint8_t>(bytes, data("types") + 8 + 1), 10);
}

TEST(WriteTetMesh, TextOfVtuHasTheSameNumbers) {
  const std::string text = written(pair(), TetFormat::vtu_ascii);
  EXPECT_NE(text.find("NumberOfPoints=\"5\" NumberOfCells=\"2\""), text.npos);
  EXPECT_NE(text.find("\n0.1 1 1\n"), text.npos);
  EXPECT_NE(text.find("\n0 1 2 3\n1 2 3 4\n"), text.npos);
  EXPECT_NE(text.find("\n4\n8\n"), text.npos);
}

TEST(WriteTetMesh, MshIsBinaryWithOneGroupForEachSide) {
  const std::string bytes = written(pair(), TetFormat::msh);
  EXPECT_EQ(bytes.substr(0, 20), "$MeshFormat\n4.1 1 8\n");
  EXPECT_EQ(at<std::int32_t>(bytes, 20), 1);
  EXPECT_NE(
      bytes.find("$PhysicalNames\n5\n2 1 \"x_min\"\n2 3 \"y_min\"\n2 5 \"z_min\"\n2 7 \"surface\"\n3 1 \"solid\"\n"),
      bytes.npos);
  const std::size_t elements = bytes.find("$Elements\n") + 10;
  EXPECT_EQ(at<std::uint64_t>(bytes, elements), 5u);      // blocks
  EXPECT_EQ(at<std::uint64_t>(bytes, elements + 8), 8u);  // six faces, two tetrahedra
  // The last element: its number, four nodes counted from 1.
  const std::size_t end = bytes.find("\n$EndElements");
  EXPECT_EQ(at<std::uint64_t>(bytes, end - 40), 8u);
  EXPECT_EQ(at<std::uint64_t>(bytes, end - 8), 5u);
}

TEST(WriteTetMesh, FormatIsToldByTheEnding) {
  EXPECT_EQ(tet_format_of("a.VTU"), TetFormat::vtu);
  EXPECT_EQ(tet_format_of("a/b.msh"), TetFormat::msh);
  EXPECT_EQ(tet_format_of("b.inp"), TetFormat::inp);
  EXPECT_FALSE(tet_format_of("b.vtk"));
}

TEST(WriteTetMesh, StopsWhenAsked) {
  StringSink bytes;
  DiagnosticSink sink;
  EXPECT_FALSE(write_tet_mesh(pair(), TetFormat::inp, bytes, {.cancelled = [] { return true; }}, sink));
  ASSERT_EQ(sink.error_count(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::cancelled);
}

}  // namespace
}  // namespace meso
