// SPDX-License-Identifier: Apache-2.0
#include "meso/import_surface_mesh/read_surface_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>

namespace meso {
namespace {

const TriangleMesh tetrahedron{{{0.1, 0, 0}, {1, 0, 1e-3}, {0, 1.25, 0}, {0, 0, -1}},
                               {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};

TriangleMesh read(std::string_view bytes, const std::string& file = "mesh") {
  DiagnosticSink sink;
  const auto mesh = read_surface_mesh(bytes, file, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return mesh.value_or(TriangleMesh{});
}

void expect_tetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.points, tetrahedron.points);
  EXPECT_EQ(mesh.triangles, tetrahedron.triangles);
}

Diagnostic only_error(std::string_view bytes, const std::string& file = "mesh") {
  DiagnosticSink sink;
  EXPECT_FALSE(read_surface_mesh(bytes, file, sink)) << bytes.substr(0, 200);
  EXPECT_EQ(sink.error_count(), 1u);
  return sink.diagnostics().empty() ? Diagnostic{} : sink.diagnostics()[0];
}

// Files as other programs write them.
constexpr std::string_view ascii_ply =
    "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info none\r\nelement vertex 4\r\nproperty uchar red\r\n"
    "property double x\r\nproperty list uchar int near\r\nproperty double y\r\nproperty float z\r\n"
    "element edge 1\r\nproperty int a\r\nproperty int b\r\nelement face 4\r\nproperty list uint8 int32 vertex_index\r\n"
    "property float quality\r\nend_header\r\n"
    "255 0.1 0 0 0\r\n0 1 2 3 1 0 1e-3\r\n0 0 0 1.25 0\r\n0 0 1 7 0 -1\r\n0 1\r\n"
    "3 0 1 2 .5\r\n3 0 3 1 .5\r\n3 0 2 3 .5\r\n3 1 3 2 .5\r\n";

constexpr std::string_view obj =
    "# comment\nmtllib a.mtl\no thing\nv 0.1 0 0\nv 1.0 0 1e-3 0.5\nvt 0 0\nvn 0 0 1\nf 1 2 -1 # forward: v 3 "
    "follows\n";

/// Writers of their own, so that a fault of a reader is not hidden by a writer with the same.
template <class T>
void append(std::string& out, T value, bool big_endian) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof value);
  if (big_endian) std::reverse(raw.begin(), raw.end());
  out.append(raw.data(), raw.size());
}

std::string binary_ply(const TriangleMesh& mesh, bool big_endian) {
  std::string out = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
                    "\nproperty double x\nproperty short flag\nproperty double y\nproperty double z\n"
                    "property list ushort float weights\nelement face " +
                    std::to_string(mesh.triangles.size()) +
                    "\nproperty uchar material\nproperty list int uint vertex_indices\nend_header\n";
  for (const Vec3& p : mesh.points) {
    append(out, p.x, big_endian);
    append(out, std::int16_t{-3}, big_endian);
    append(out, p.y, big_endian);
    append(out, p.z, big_endian);
    append(out, std::uint16_t{2}, big_endian);
    append(out, 0.5f, big_endian);
    append(out, 1.5f, big_endian);
  }
  for (const auto& t : mesh.triangles) {
    append(out, std::uint8_t{9}, big_endian);
    append(out, std::int32_t{3}, big_endian);
    for (const std::uint32_t i : t) append(out, i, big_endian);
  }
  return out;
}

std::string off(const std::string& keyword, const std::string& after_point, const std::string& after_face) {
  return keyword + "# tetrahedron\n\n4 4 6\n0.1 0 0" + after_point + "\n1 0 1e-3" + after_point +
         "\n  # between\n0 1.25 0" + after_point + "\n0 0 -1" + after_point + "\n3 0 1 2" + after_face +
         "\n3 0 3 1\n3 0 2 3" + after_face + "\n3 1 3 2";
}

TEST(ReadSurfaceMesh, ReadsPly) {
  expect_tetrahedron(read(ascii_ply));
  expect_tetrahedron(read(binary_ply(tetrahedron, false)));
  expect_tetrahedron(read(binary_ply(tetrahedron, true)));
}

TEST(ReadSurfaceMesh, ReadsEveryTypeOfPlyInBothByteOrders) {
  for (const bool big : {false, true}) {
    std::string file = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                       "_endian 1.0\nelement vertex 3\nproperty int8 x\nproperty ushort y\nproperty uint z\n"
                       "element face 1\nproperty list char short vertex_indices\nend_header\n";
    for (const int i : {0, 1, 2}) {
      append(file, static_cast<std::int8_t>(-i), big);
      append(file, static_cast<std::uint16_t>(40'000 + i), big);
      append(file, 4'000'000'000u, big);
    }
    append(file, std::int8_t{3}, big);
    for (const std::int16_t i : {2, 1, 0}) append(file, i, big);
    const TriangleMesh mesh = read(file);
    EXPECT_EQ(mesh.points, (std::vector<Vec3>{{0, 40'000, 4e9}, {-1, 40'001, 4e9}, {-2, 40'002, 4e9}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{2, 1, 0}}));
  }
}

TEST(ReadSurfaceMesh, ReadsObj) {
  expect_tetrahedron(
      read("# a comment\nmtllib a.mtl\no thing\nv 0.1 0 0\nv 1 0 1e-3 0.5\nvt 0 0\nvn 0 0 1\n"
           "f 1 2 3\nv +0 1.25 0 1 0 0\r\nv 0 0 -1\ng side\ns 1\nf 1//1 4//1 2//1\n"
           "f -4/1 \\\n -2/1 -1/1\nf 2/1/1 4/1/1 3/1/1 # end"));
  // One square face, as most programs write them.
  const TriangleMesh square = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_EQ(square.points.size(), 4u);
  EXPECT_EQ(square.triangles.size(), 2u);
}

TEST(ReadSurfaceMesh, ReadsOffVariants) {
  expect_tetrahedron(read(off("OFF ", "", "")));
  expect_tetrahedron(read(off("OFF\n", " 255 0 0", " 0.5 0.5 0.5")));
  expect_tetrahedron(read(off("COFF\n", " 1 0 0 1", "")));
  expect_tetrahedron(read(off("NOFF\n", " 0 0 1", " 7")));
  expect_tetrahedron(read(off("STCNOFF\n", " 0 0 1 0.2 0.2 0.2 1 0 0", "")));
  expect_tetrahedron(read(off("", "", ""), "without_keyword.off"));
}

TEST(ReadSurfaceMesh, TellsFormatsApart) {
  std::string solid(84 + 50, '\0');
  std::memcpy(solid.data(), "solid", 5);
  solid[80] = 1;
  const float one = 1;
  std::memcpy(solid.data() + 84 + 12 + 12, &one, 4);
  std::memcpy(solid.data() + 84 + 12 + 28, &one, 4);
  EXPECT_EQ(read(solid).points.size(), 3u);  // binary STL with the word of ASCII STL
  EXPECT_EQ(
      read("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
           "endsolid a\n")
          .triangles.size(),
      1u);
  expect_tetrahedron(read(binary_ply(tetrahedron, false), "misnamed.stl"));
  EXPECT_EQ(only_error("<html>").code, Code::mesh_file_format);
  EXPECT_EQ(only_error("").code, Code::mesh_file_format);
}

TEST(ReadSurfaceMesh, RoundTripsEveryDouble) {
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i) {
    const auto x = std::ldexp(1.0 + i / 7.0, i % 200 - 100);
    mesh.points.push_back({x, -x / 3, 1 / x});
  }
  for (std::uint32_t i = 0; i + 2 < 300; ++i) mesh.triangles.push_back({i, i + 2, i + 1});
  const TriangleMesh again = read(binary_ply(read(binary_ply(mesh, true)), false));
  EXPECT_EQ(again.points, mesh.points);
  EXPECT_EQ(again.triangles, mesh.triangles);
}

TEST(ReadSurfaceMesh, PointsAtTheFault) {
  std::string text(ascii_ply);
  text.replace(text.find("1.25"), 4, "1,25");
  const Diagnostic d = only_error(text);
  EXPECT_EQ(d.code, Code::mesh_file_syntax);
  EXPECT_EQ(d.where.line, 20u);
  EXPECT_EQ(d.where.column, 7u);
  EXPECT_EQ(d.args, (std::vector<std::string>{"a number", "1,25"}));
  const Diagnostic index = only_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\nv 0 0 1\n");
  EXPECT_EQ(index.code, Code::mesh_file_index);
  EXPECT_EQ(index.where.line, 5u);
  EXPECT_EQ(index.args, (std::vector<std::string>{"9", "4"}));
  EXPECT_EQ(only_error("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n").where.line, 4u);
  std::string binary = binary_ply(tetrahedron, false);
  binary[binary.size() - 1] = '\x7f';
  EXPECT_EQ(only_error(binary).where.offset, binary.size());
}

TEST(ReadSurfaceMesh, NamesWhatIsWrong) {
  EXPECT_EQ(only_error("v 0 0 nan\nf 1 1 1").code, Code::mesh_file_not_finite);
  EXPECT_EQ(only_error("v 0 0 1e999\nf 1 1 1").code, Code::mesh_file_not_finite);
  EXPECT_EQ(only_error("v 0 0 0\nf 1 1").code, Code::mesh_file_syntax);
  EXPECT_EQ(only_error("v 0 0 0\nf 0 1 1").code, Code::mesh_file_index);
  EXPECT_EQ(only_error("v 0 0 0\nf 1 1 -2").code, Code::mesh_file_index);
  EXPECT_EQ(only_error("v 0 0 0\nf 1 99999999999 1").code, Code::mesh_file_index);
  EXPECT_EQ(only_error("v 0 0 0\n").code, Code::mesh_file_empty);
  EXPECT_EQ(only_error("4OFF\n0 0 0\n").code, Code::mesh_file_unsupported);
  EXPECT_EQ(only_error("OFF BINARY\n").code, Code::mesh_file_unsupported);
  EXPECT_EQ(only_error("OFF\n1 1 0\n0 0 0\n2 0 0\n").code, Code::mesh_file_syntax);
  EXPECT_EQ(only_error("ply\nformat ascii 2.0\nend_header\n").code, Code::mesh_file_syntax);
  EXPECT_EQ(only_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float y\nend_header\n0\n").code,
            Code::mesh_file_unsupported);
  EXPECT_EQ(only_error("ply\nformat ascii 1.0\n").code, Code::mesh_file_syntax);
  for (const std::string count : {"nan", "3.5", "2", "-1", "inf"})
    EXPECT_EQ(only_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n"
                         "element face 1\nproperty list int int vertex_index\nend_header\n0 0 0\n" +
                         count + " 0 0 0 0\n")
                  .code,
              Code::mesh_file_syntax)
        << count;
}

TEST(ReadSurfaceMesh, TakesNoMemoryForCountsThatTheFileCannotHold) {
  for (const std::string& bytes :
       {std::string("OFF\n4000000000 4000000000 0\n0 0 0\n"),
        std::string("ply\nformat ascii 1.0\nelement vertex 9000000000000000000\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n0 0 0\n"),
        std::string("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
                    "property float y\nproperty float z\nend_header\n0123456789abcdef"),
        std::string("ply\nformat binary_little_endian 1.0\nelement face 4294967295\nproperty list uint int "
                    "vertex_indices\nend_header\n\xff\xff\xff\x7f")})
    EXPECT_EQ(only_error(bytes).code, Code::mesh_file_truncated);
  EXPECT_EQ(only_error("ply\nformat binary_little_endian 1.0\nelement vertex 9000000000000000000\nelement face 1\n"
                       "property list uint int vertex_indices\nend_header\n\xff\xff\xff\x7f")
                .code,
            Code::mesh_file_unsupported);  // points without coordinates
}

/// Every file cut anywhere, and with any byte changed, ends in a mesh or in one error.
TEST(ReadSurfaceMesh, SurvivesDamage) {
  for (const std::string& whole :
       {std::string(ascii_ply), binary_ply(tetrahedron, true), off("COFF\n", " 1 0 0 1", ""), std::string(obj)}) {
    std::size_t errors = 0;
    const auto try_it = [&](const std::string& bytes) {
      DiagnosticSink sink;
      const auto mesh = read_surface_mesh(bytes, "mesh.obj", sink);
      EXPECT_EQ(sink.error_count(), mesh ? 0u : 1u);
      errors += sink.error_count();
      if (!mesh) return;
      for (const auto& t : mesh->triangles) EXPECT_LT(std::max({t[0], t[1], t[2]}), mesh->points.size());
    };
    for (std::size_t n = 0; n < whole.size(); ++n) {
      try_it(whole.substr(0, n));
      for (const char c : {'\0', '\xff', ' ', '9', '-'}) {
        std::string damaged = whole;
        damaged[n] = c;
        try_it(damaged);
      }
    }
    EXPECT_GT(errors, whole.size() / 3);
  }
}

TEST(ReadSurfaceMesh, ReadsFiles) {
  const std::string path = ::testing::TempDir() + "meso_read_surface_mesh_test.ply";
  std::ofstream(path, std::ios::binary) << binary_ply(tetrahedron, false);
  DiagnosticSink sink;
  const auto mesh = read_surface_mesh_file(path, sink);
  ASSERT_TRUE(mesh);
  expect_tetrahedron(*mesh);
  EXPECT_FALSE(read_surface_mesh_file(path + ".not_there", sink));
  EXPECT_EQ(sink.diagnostics().back().code, Code::file_not_found);
  EXPECT_FALSE(read_surface_mesh_file(::testing::TempDir(), sink));
}

TEST(ReadSurfaceMesh, FilesMayNotTakeMoreThanTheirShareOfTheBudget) {
  const auto told = [](const std::filesystem::path& path, const RunOptions& run) {
    DiagnosticSink sink;
    EXPECT_FALSE(read_surface_mesh_file(path, sink, run));
    return sink.diagnostics().at(0).code;
  };
  EXPECT_EQ(told("/dev/zero", {.max_memory_bytes = 1u << 24}), Code::file_too_large);  // it never ends
  EXPECT_EQ(told("/dev/zero", {.cancelled = [] { return true; }}), Code::cancelled);
  EXPECT_EQ(told("/dev/zero", {.deadline = std::chrono::steady_clock::now()}), Code::limit_time);
}

TEST(ReadPly, RefusesPointsWithoutCoordinates) {
  constexpr std::string_view start = "ply\nformat ascii 1.0\nelement vertex 4000000000\nelement face 1\n";
  for (const std::string_view face : {"4 0 1000000000 2000000000 3\n", "3 0 1 2\n"}) {
    const std::string text =
        std::string(start) + "property list uchar int vertex_indices\nend_header\n" + std::string(face);
    EXPECT_EQ(only_error(text).code, Code::mesh_file_unsupported);
  }
}

}  // namespace
}  // namespace meso
