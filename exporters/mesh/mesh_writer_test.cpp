// SPDX-License-Identifier: Apache-2.0
#include "meso/export_mesh/mesh_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/import_surface_mesh/read_stl.hpp"
#include "meso/mesh/audit_mesh.hpp"

namespace meso {
namespace {

namespace fs = std::filesystem;

// Coordinates that are floats, so that a file gives them back.
TriangleMesh octahedron() {
  return {{{1.5, 0, -0.0}, {-1, 0, 0}, {0, 0.125, 0}, {0, -1e-3F, 0}, {0.1F, 0, 1}, {0, 0, -12345.678F}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

std::string written(const TriangleMesh& mesh, MeshFormat format, Coordinates coordinates = Coordinates::as_float) {
  const std::string path = (fs::temp_directory_path() / ("meso_mesh_" + std::to_string(getpid()))).string();
  DiagnosticSink diagnostics;
  auto file = OutputFile::create(path, ExistingFile::replace, diagnostics);
  const std::unique_ptr<MeshSink> writer = make_mesh_writer(format, *file, coordinates);
  EXPECT_TRUE(write_mesh(mesh, *writer));
  EXPECT_TRUE(file->commit(diagnostics));
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  fs::remove(path);
  return bytes;
}

template <class T>
T take(std::string_view& bytes, bool big_endian = false) {
  std::array<char, sizeof(T)> raw{};
  bytes.copy(raw.data(), raw.size());
  bytes.remove_prefix(raw.size());
  if (big_endian) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

// What stands behind `key` in a header of words.
std::uint64_t count_after(std::string_view header, const std::string& key) {
  std::uint64_t n = 0;
  std::istringstream(std::string(header.substr(header.find(key) + key.size()))) >> n;
  return n;
}

std::string_view after(std::string_view text, std::string_view key) { return text.substr(text.find(key) + key.size()); }

template <class Real>
TriangleMesh parse_ply(std::string_view bytes) {
  EXPECT_TRUE(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  const std::string real = sizeof(Real) == 4 ? "float" : "double";
  EXPECT_NE(bytes.find("property " + real + " x\nproperty " + real + " y\nproperty " + real + " z\nelement face"),
            std::string_view::npos);
  EXPECT_NE(bytes.find("property list uchar int vertex_indices\n"), std::string_view::npos);
  TriangleMesh mesh;
  mesh.points.resize(count_after(bytes, "element vertex"));
  mesh.triangles.resize(count_after(bytes, "element face"));
  std::string_view data = after(bytes, "end_header\n");
  for (Vec3& p : mesh.points)
    for (std::size_t i = 0; i < 3; ++i) p[i] = take<Real>(data);
  for (auto& t : mesh.triangles) {
    EXPECT_EQ(take<std::uint8_t>(data), 3);
    for (std::uint32_t& corner : t) corner = take<std::uint32_t>(data);
  }
  EXPECT_TRUE(data.empty());
  return mesh;
}

template <class Real>
TriangleMesh parse_vtk(std::string_view bytes) {
  EXPECT_TRUE(bytes.starts_with("# vtk DataFile Version 3.0\n"));
  EXPECT_NE(bytes.find("\nBINARY\nDATASET POLYDATA\n"), std::string_view::npos);
  TriangleMesh mesh;
  mesh.points.resize(count_after(bytes, "POINTS"));
  std::string_view data = after(bytes, sizeof(Real) == 4 ? " float\n" : " double\n");
  for (Vec3& p : mesh.points)
    for (std::size_t i = 0; i < 3; ++i) p[i] = take<Real>(data, true);
  EXPECT_TRUE(data.starts_with("\nPOLYGONS "));
  mesh.triangles.resize(count_after(data, "POLYGONS"));
  EXPECT_EQ(count_after(data, "POLYGONS " + std::string(12, ' ').substr(0, 11) + std::to_string(mesh.triangles.size())),
            4 * mesh.triangles.size());
  data = after(data.substr(1), "\n");
  for (auto& t : mesh.triangles) {
    EXPECT_EQ(take<std::uint32_t>(data, true), 3u);
    for (std::uint32_t& corner : t) corner = take<std::uint32_t>(data, true);
  }
  EXPECT_EQ(data, "\n");
  return mesh;
}

template <class Real = float>
TriangleMesh parse_obj(std::string_view text) {
  TriangleMesh mesh;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    if (kind == "v")
      mesh.points.push_back(
          {static_cast<Real>(std::stod(a)), static_cast<Real>(std::stod(b)), static_cast<Real>(std::stod(c))});
    if (kind == "f")
      mesh.triangles.push_back({static_cast<std::uint32_t>(std::stoul(a) - 1),
                                static_cast<std::uint32_t>(std::stoul(b) - 1),
                                static_cast<std::uint32_t>(std::stoul(c) - 1)});
  }
  return mesh;
}

template <class Real = float>
TriangleMesh parse_off(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string off;
  std::size_t points = 0, triangles = 0, edges = 1, corners = 0;
  words >> off >> points >> triangles >> edges;
  EXPECT_EQ(off, "OFF");
  EXPECT_EQ(edges, 0u);
  TriangleMesh mesh;
  mesh.points.resize(points);
  mesh.triangles.resize(triangles);
  for (Vec3& p : mesh.points)
    for (std::size_t i = 0; i < 3; ++i) {
      double c = 0;
      words >> c;
      p[i] = static_cast<Real>(c);
    }
  for (auto& t : mesh.triangles) {
    words >> corners >> t[0] >> t[1] >> t[2];
    EXPECT_EQ(corners, 3u);
  }
  EXPECT_TRUE(words >> std::ws && words.eof());
  return mesh;
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(MeshWriter, PlyReadsBack) { expect_same(parse_ply<float>(written(octahedron(), MeshFormat::ply)), octahedron()); }

TEST(MeshWriter, PlyKeepsDoubles) {
  TriangleMesh mesh = octahedron();
  mesh.points[0].x = 0.1;
  expect_same(parse_ply<double>(written(mesh, MeshFormat::ply, Coordinates::as_double)), mesh);
}

TEST(MeshWriter, OtherFormatsKeepDoublesToo) {
  TriangleMesh mesh = octahedron();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.points[i] += Vec3{1e9, 0.1, -1. / 3};
  expect_same(parse_obj<double>(written(mesh, MeshFormat::obj, Coordinates::as_double)), mesh);
  expect_same(parse_off<double>(written(mesh, MeshFormat::off, Coordinates::as_double)), mesh);
  expect_same(parse_vtk<double>(written(mesh, MeshFormat::vtk, Coordinates::as_double)), mesh);
}

TEST(MeshWriter, PlyBeginsItsDataAfter256Bytes) {
  const std::string bytes = written(octahedron(), MeshFormat::ply);
  EXPECT_EQ(bytes.find("end_header\n") + 11, 256u);
  EXPECT_EQ(bytes.size(), 256u + 6 * 12 + 8 * 13);
}

TEST(MeshWriter, VtkReadsBack) { expect_same(parse_vtk<float>(written(octahedron(), MeshFormat::vtk)), octahedron()); }

TEST(MeshWriter, ObjReadsBack) { expect_same(parse_obj(written(octahedron(), MeshFormat::obj)), octahedron()); }

TEST(MeshWriter, OffReadsBack) { expect_same(parse_off(written(octahedron(), MeshFormat::off)), octahedron()); }

TEST(MeshWriter, TextHasOneZero) { EXPECT_EQ(written(octahedron(), MeshFormat::obj).find("-0 "), std::string::npos); }

TEST(MeshWriter, StlReadsBack) {
  for (const MeshFormat format : {MeshFormat::stl, MeshFormat::stl_ascii}) {
    DiagnosticSink diagnostics;
    const auto mesh = read_stl(written(octahedron(), format), "o.stl", diagnostics);
    ASSERT_TRUE(mesh);
    const MeshAudit audit = audit_mesh(*mesh), truth = audit_mesh(octahedron());
    EXPECT_TRUE(audit.watertight());
    EXPECT_EQ(audit.triangles, 8u);
    EXPECT_NEAR(audit.volume, truth.volume, 1e-4);  // text is read as doubles
  }
}

TEST(MeshWriter, StlLeavesOutFoldedTrianglesAndCountsTheRest) {
  TriangleMesh mesh = octahedron();
  mesh.points.push_back({1.5 + 1e-12, 0, 0});  // the same float as point 0
  mesh.triangles[0][0] = 6;  // one corner of the fan moves, its gap is closed by a sliver on each side
  mesh.triangles.push_back({0, 6, 4});
  mesh.triangles.push_back({6, 0, 2});
  DiagnosticSink diagnostics;
  const auto back = read_stl(written(mesh, MeshFormat::stl), "o.stl", diagnostics);
  ASSERT_TRUE(back) << render(diagnostics.diagnostics().at(0));
  EXPECT_EQ(back->triangles.size(), 8u);
  EXPECT_TRUE(audit_mesh(*back).watertight());
}

TEST(MeshWriter, StlKeepsMoreThanOnePieceOfPoints) {
  TriangleMesh mesh;
  for (int i = 0; i < 70000; ++i) mesh.points.push_back({static_cast<double>(i), 1, 0});
  mesh.points.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i + 1 < 70000; i += 7) mesh.triangles.push_back({i, i + 1, 70000});
  DiagnosticSink diagnostics;
  const auto back = read_stl(written(mesh, MeshFormat::stl), "o.stl", diagnostics);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->points[back->triangles.back()[0]], mesh.points[mesh.triangles.back()[0]]);
  EXPECT_EQ(back->triangles.size(), mesh.triangles.size());
}

TEST(MeshWriter, EmptyMeshesAreFiles) {
  expect_same(parse_ply<float>(written({}, MeshFormat::ply)), {});
  expect_same(parse_vtk<float>(written({}, MeshFormat::vtk)), {});
  expect_same(parse_off(written({}, MeshFormat::off)), {});
  EXPECT_EQ(written({}, MeshFormat::stl).size(), 84u);
}

TEST(MeshFormatOf, GoesByTheEnding) {
  EXPECT_EQ(mesh_format_of("a/b.PLY"), MeshFormat::ply);
  EXPECT_EQ(mesh_format_of("b.vtk"), MeshFormat::vtk);
  EXPECT_FALSE(mesh_format_of("b.step"));
  EXPECT_FALSE(mesh_format_of("ply"));
}

}  // namespace
}  // namespace meso
