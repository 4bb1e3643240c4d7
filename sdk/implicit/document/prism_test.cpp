// SPDX-License-Identifier: Apache-2.0
// Prisms found in meshes, against the distance to those meshes.
#include "prism.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "document_for_test.hpp"
#include "meso/mesh_distance/mesh_field.hpp"

namespace meso::implicit {
namespace {

/// The plate [0, 4] x [0, 3] x [1, 2] with a hole of any number of sides, its coordinates turned so that z becomes
/// `axis`.
TriangleMesh plate(std::size_t axis, std::size_t hole_sides = 7) {
  const std::array<std::array<double, 2>, 4> corners{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}};
  TriangleMesh mesh;
  const auto add_ring = [&](double z) {
    for (const auto& [x, y] : corners) mesh.points.push_back({x, y, z});
    for (std::size_t i = 0; i < hole_sides; ++i) {
      const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(hole_sides);
      mesh.points.push_back({2 + std::cos(angle), 1.5 + std::sin(angle), z});
    }
  };
  add_ring(1), add_ring(2);
  const auto ring = static_cast<std::uint32_t>(4 + hole_sides);
  const auto hole = [&](std::size_t i) { return static_cast<std::uint32_t>(4 + i % hole_sides); };
  const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {  // of the top, and below it
    mesh.triangles.push_back({ring + a, ring + b, ring + c});
    mesh.triangles.push_back({a, c, b});
  };
  const auto wall = [&](std::uint32_t a, std::uint32_t b) {  // with the body to its left
    mesh.triangles.push_back({a, b, ring + b});
    mesh.triangles.push_back({a, ring + b, ring + a});
  };
  // The corner a side of the hole sees; where it changes, a triangle has two corners.
  const auto corner_of = [&](std::size_t i) {
    const double angle = 2 * M_PI * (static_cast<double>(i % hole_sides) + 0.5) / static_cast<double>(hole_sides);
    const double x = std::cos(angle), y = std::sin(angle);
    return static_cast<std::uint32_t>(y < 0 ? (x < 0 ? 0 : 1) : (x < 0 ? 3 : 2));
  };
  for (std::size_t i = 0; i < hole_sides; ++i) {
    face(corner_of(i), hole(i + 1), hole(i));
    if (corner_of(i) != corner_of(i + 1)) face(corner_of(i), corner_of(i + 1), hole(i + 1));
    wall(hole(i + 1), hole(i));
  }
  for (std::uint32_t i = 0; i < 4; ++i) wall(i, (i + 1) % 4);
  for (Vec3& p : mesh.points) p = {p[(5 - axis) % 3], p[(6 - axis) % 3], p[(7 - axis) % 3]};
  return mesh;
}

TEST(Prism, IsTheBodyOfItsMeshAlongEveryAxis) {
  for (const std::size_t axis : {0U, 1U, 2U}) {
    const TriangleMesh mesh = plate(axis);
    DiagnosticSink sink;
    const auto distance = MeshField::make(mesh, "plate", {}, sink);
    ASSERT_TRUE(distance && distance->quality().closed);
    const auto prism = prism_field(mesh);
    ASSERT_TRUE(prism) << axis;
    Box3 box;
    for (const Vec3& p : mesh.points) box.extend(p);
    EXPECT_EQ(prism->bounds().min, box.min);
    EXPECT_EQ(prism->bounds().max, box.max);
    RandomPoints points({box.min - Vec3{1, 1, 1}, box.max + Vec3{1, 1, 1}});
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = points();
      const double exact = distance->value(p), found = prism->value(p);
      ASSERT_EQ(found < 0, exact < 0);
      if (exact < 0)
        ASSERT_NEAR(found, exact, 1e-12);
      else
        ASSERT_LE(found, exact + 1e-12);  // beside an edge of the ends the greater of two distances
      inside += exact < 0 ? 1 : 0;
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(Prism, OtherMeshesAreNone) {
  TriangleMesh leaning = plate(2);
  for (Vec3& p : leaning.points) p.x += 0.1 * p.z;
  EXPECT_FALSE(prism_field(leaning));
  TriangleMesh tapered = plate(2);
  for (Vec3& p : tapered.points)
    if (p.z > 1.5) p.x *= 0.9;
  EXPECT_FALSE(prism_field(tapered));
  TriangleMesh open = plate(2);
  open.triangles.pop_back();
  open.triangles.pop_back();
  EXPECT_FALSE(prism_field(open));
  EXPECT_FALSE(prism_field(plate(2, 1000))) << "too many sides for a table";
  EXPECT_FALSE(prism_field({}));
}

TEST(Prism, AnImportedOneGivesTheSamePart) {
  const std::string document =
      "<macrostructures><macrostructure id='m'><import href='plate.stl' unit='millimeter'/></macrostructure>"
      "</macrostructures>" +
      part_of("");
  const auto file = std::filesystem::path("plate.stl");
  { std::ofstream(file) << "solid\nendsolid\n"; }
  const TestDocument made(document, "p", [](const auto&, auto&) { return plate(0); });
  std::filesystem::remove(file);
  EXPECT_NEAR(volume_by_points(made.field(), 80), 4 * 3 - 3.5 * std::sin(2 * M_PI / 7), 0.02);
}

}  // namespace
}  // namespace meso::implicit
