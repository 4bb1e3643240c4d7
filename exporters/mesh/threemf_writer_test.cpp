// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>
#include <zip.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/export_mesh/mesh_writer.hpp"

namespace meso {
namespace {

namespace fs = std::filesystem;

TriangleMesh tetrahedron() {
  return {{{0, 0, -0.0}, {0.1F, 0, 0}, {0, 1e-7F, 0}, {0, 0, -12345.678F}},
          {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
}

class ThreeMf : public testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }

  void write(const TriangleMesh& mesh) {
    DiagnosticSink diagnostics;
    auto file = OutputFile::create(path_, ExistingFile::replace, diagnostics);
    ASSERT_TRUE(file);
    ASSERT_TRUE(write_mesh(mesh, *make_mesh_writer(*mesh_format_of(path_), *file)));
    ASSERT_TRUE(file->commit(diagnostics));
  }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// By libzip, which checks sums and the archive's consistency.
  [[nodiscard]] std::string entry(const char* name) const {
    zip_t* zip = zip_open(path_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
    if (zip == nullptr) return "no archive";
    std::string text;
    if (zip_file_t* file = zip_fopen(zip, name, 0); file != nullptr) {
      for (char c = 0; zip_fread(file, &c, 1) == 1;) text += c;
      zip_fclose(file);
    }
    zip_close(zip);
    return text;
  }

  std::string path_ = (fs::temp_directory_path() / ("meso_" + std::to_string(getpid()) + ".3mf")).string();
};

TEST_F(ThreeMf, ReadsBack) {
  write(tetrahedron());
  const std::string model = entry("3D/3dmodel.model");
  EXPECT_NE(model.find("unit=\"millimeter\""), std::string::npos);
  EXPECT_EQ(model.find("\"-0\""), std::string::npos);
  TriangleMesh mesh;
  const std::regex point("<vertex x=\"(\\S+)\" y=\"(\\S+)\" z=\"(\\S+)\"/>"),
      triangle("<triangle v1=\"(\\d+)\" v2=\"(\\d+)\" v3=\"(\\d+)\"/>");
  for (std::sregex_iterator it(model.begin(), model.end(), point), end; it != end; ++it)
    mesh.points.push_back({std::stof((*it)[1]), std::stof((*it)[2]), std::stof((*it)[3])});
  for (std::sregex_iterator it(model.begin(), model.end(), triangle), end; it != end; ++it) {
    const auto index = [&](std::size_t i) { return static_cast<std::uint32_t>(std::stoul((*it)[i])); };
    mesh.triangles.push_back({index(1), index(2), index(3)});
  }
  EXPECT_EQ(mesh.points, tetrahedron().points);
  EXPECT_EQ(mesh.triangles, tetrahedron().triangles);
}

TEST_F(ThreeMf, IsAPackageThatNamesItsModel) {
  write(tetrahedron());
  EXPECT_NE(entry("[Content_Types].xml").find("application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
            std::string::npos);
  EXPECT_NE(entry("_rels/.rels").find("Target=\"/3D/3dmodel.model\""), std::string::npos);
}

TEST_F(ThreeMf, EqualMeshesAreEqualBytes) {
  write(tetrahedron());
  const std::string first = bytes();
  write(tetrahedron());
  EXPECT_EQ(bytes(), first);
}

}  // namespace
}  // namespace meso
