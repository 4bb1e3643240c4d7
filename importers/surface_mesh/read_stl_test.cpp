// SPDX-License-Identifier: Apache-2.0
#include "meso/import_surface_mesh/read_stl.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace meso {
namespace {

constexpr std::string_view two_facets =
    "solid thing one\n"
    " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5e0 0 0\n   vertex 0 +1 0\n  endloop\n endfacet\n"
    " facet normal 0 0 1\n  outer loop\n   vertex 1.5 0 -0\n   vertex 1.5 1 0\n   vertex 0 1 0\n  endloop\n endfacet\n"
    "endsolid thing one\n";

std::string binary(std::uint32_t announced, const std::vector<std::array<float, 9>>& facets) {
  std::string bytes(84, '\0');
  std::memcpy(bytes.data(), "solid but binary", 16);
  std::memcpy(bytes.data() + 80, &announced, 4);
  for (const auto& facet : facets) {
    std::string record(50, '\0');
    std::memcpy(record.data() + 12, facet.data(), 36);
    bytes += record;
  }
  return bytes;
}

constexpr std::array<float, 9> facet{0, 0, 0, 1, 0, 0, 0, 1, 0};

Code only_error(std::string_view bytes) {
  DiagnosticSink sink;
  EXPECT_FALSE(read_stl(bytes, "f.stl", sink));
  EXPECT_EQ(sink.error_count(), 1u);
  return sink.diagnostics().at(0).code;
}

TEST(ReadStl, WeldsEqualCornersOfAscii) {
  DiagnosticSink sink;
  const auto mesh = read_stl(two_facets, "f.stl", sink);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->points, (std::vector<Vec3>{{0, 0, 0}, {1.5, 0, 0}, {0, 1, 0}, {1.5, 1, 0}}));
  EXPECT_EQ(mesh->triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
}

TEST(ReadStl, ReadsBinaryThatBeginsWithSolid) {
  DiagnosticSink sink;
  const auto mesh = read_stl(binary(2, {facet, {1, 0, 0, 1, 1, 0, 0, 1, 0}}), "f.stl", sink);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->points.size(), 4u);
  EXPECT_EQ(mesh->triangles.size(), 2u);
}

TEST(ReadStl, RefusesDamagedBinary) {
  const std::string whole = binary(2, {facet, facet});
  // A header of zeros cannot be mistaken for ASCII, so that the size is what is judged.
  std::string plain = whole;
  std::memset(plain.data(), 0, 80);
  EXPECT_EQ(only_error(plain.substr(0, plain.size() - 1)), Code::stl_truncated);
  EXPECT_EQ(only_error(plain.substr(0, 60)), Code::stl_truncated);
  EXPECT_EQ(only_error(plain + "x"), Code::stl_extra_bytes);
  EXPECT_EQ(only_error(binary(0, {})), Code::stl_empty);
  auto bad = facet;
  bad[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(only_error(binary(1, {bad})), Code::stl_not_finite);
}

TEST(ReadStl, PointsAtTheSyntaxError) {
  std::string text(two_facets);
  text.replace(text.find("1.5e0"), 5, "1,5");
  DiagnosticSink sink;
  EXPECT_FALSE(read_stl(text, "f.stl", sink));
  ASSERT_EQ(sink.error_count(), 1u);
  const Diagnostic& d = sink.diagnostics()[0];
  EXPECT_EQ(d.code, Code::stl_syntax);
  EXPECT_EQ(d.args, (std::vector<std::string>{"a number", "1,5"}));
  EXPECT_EQ(d.where.line, 5u);
  EXPECT_EQ(d.where.column, 11u);
}

TEST(ReadStl, RefusesDamagedAscii) {
  const std::string text(two_facets);
  EXPECT_EQ(only_error(text.substr(0, text.size() / 2)), Code::stl_syntax);
  EXPECT_EQ(only_error(text.substr(0, text.rfind("endsolid"))), Code::stl_syntax);
  EXPECT_EQ(only_error("solid nothing\nendsolid\n"), Code::stl_empty);
  for (const std::string_view bad : {"nan", "inf", "1e999"}) {
    std::string damaged = text;
    damaged.replace(damaged.find("1.5e0"), 5, bad);
    EXPECT_EQ(only_error(damaged), Code::stl_not_finite) << bad;
  }
  EXPECT_EQ(only_error(""), Code::stl_truncated);
}

}  // namespace
}  // namespace meso
