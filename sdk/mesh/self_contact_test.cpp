// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/self_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace meso {
namespace {

void add_tetrahedron(TriangleMesh& mesh, Vec3 at, double size) {
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    mesh.points.push_back(at + size * p);
  for (const auto& t :
       {std::array{0U, 2U, 1U}, std::array{0U, 1U, 3U}, std::array{0U, 3U, 2U}, std::array{1U, 2U, 3U}}) {
    mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
}

TEST(SelfContact, NoneInBodiesApart) {
  TriangleMesh mesh;
  for (int i = 0; i < 10; ++i) add_tetrahedron(mesh, {2.0 * i, 0, 0}, 1.5);
  EXPECT_EQ(count_self_contacts(mesh).pairs, 0U);
}

TEST(SelfContact, FindsCrossingBodies) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, {0, 0, 0}, 1);
  add_tetrahedron(mesh, {0.1, 0.1, -0.5}, 1);
  const SelfContacts found = count_self_contacts(mesh);
  EXPECT_GT(found.pairs, 0U);
  EXPECT_EQ(found.deep, found.pairs);
  EXPECT_TRUE(found.place.has_value());
  EXPECT_EQ(count_self_contacts(mesh, {}, 1).pairs, 1U);
}

TEST(SelfContact, TellsWhichTrianglesCross) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, {0, 0, 0}, 1);
  add_tetrahedron(mesh, {0.1, 0.1, -0.5}, 1);
  add_tetrahedron(mesh, {3, 3, 3}, 1);
  const std::vector<double> none(mesh.triangles.size(), 0), large(mesh.triangles.size(), 1);
  const auto pairs = deep_self_contacts(mesh, none, 100);
  EXPECT_EQ(pairs.size(), count_self_contacts(mesh, none).deep);
  for (const auto& [s, t] : pairs) {
    EXPECT_LT(s, 4u);  // one triangle of each of the two
    EXPECT_TRUE(t >= 4 && t < 8);
    const auto corners = [&](std::uint32_t i) {
      const auto& [a, b, c] = mesh.triangles[i];
      return Triangle{mesh.points[a], mesh.points[b], mesh.points[c]};
    };
    EXPECT_TRUE(triangles_meet(corners(s), corners(t)));
    EXPECT_FALSE(triangles_meet(corners(s), corners(9)));
  }
  EXPECT_EQ(deep_self_contacts(mesh, none, 2).size(), 2u);
  EXPECT_TRUE(deep_self_contacts(mesh, large, 100).empty());
}

/// A ring of `sides` flat strips around the z axis, each two triangles.
void add_prism(TriangleMesh& mesh, Vec3 at, double radius, std::uint32_t sides, double turn) {
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / sides;
    for (const double z : {0.0, 10.0})
      mesh.points.push_back(at + Vec3{radius * std::cos(angle), radius * std::sin(angle), z});
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = n + 2 * i, b = n + 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
}

TEST(SelfContact, ChordHeightsOfACylinder) {
  TriangleMesh mesh;
  add_prism(mesh, {}, 1, 24, 0);
  const double height = 1 - std::cos(std::numbers::pi / 24);
  for (const double h : chord_heights(mesh)) {
    EXPECT_GE(h, height);
    EXPECT_LE(h, 3 * height);
  }
}

TEST(SelfContact, ChordHeightsKnowEdges) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, {0, 0, 0}, 1);
  for (const double h : chord_heights(mesh)) EXPECT_EQ(h, 0);
}

// Corners of one cylinder stand in the thin gap around the other and pass its chords; they do not pass its surface.
TEST(SelfContact, ChordsThatCrossAreNotDeep) {
  TriangleMesh mesh;
  add_prism(mesh, {}, 1, 24, 0);
  add_prism(mesh, {}, 0.999, 24, std::numbers::pi / 24);
  const SelfContacts found = count_self_contacts(mesh, chord_heights(mesh));
  EXPECT_GT(found.pairs, 0U);
  EXPECT_EQ(found.deep, 0U);
  EXPECT_LT(found.deepest_mm, 2 * (1 - std::cos(std::numbers::pi / 24)));
}

TEST(SelfContact, CylindersThatCrossAreDeep) {
  TriangleMesh mesh;
  add_prism(mesh, {}, 1, 24, 0);
  add_prism(mesh, {1.5, 0, 0}, 1, 24, 0.1);
  EXPECT_GT(count_self_contacts(mesh, chord_heights(mesh)).deep, 0U);
}

TEST(SelfContact, FindsFacesThatLieOnEachOther) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 0}, {0.4, 0.1, 0}, {0.1, 0.4, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
  EXPECT_EQ(count_self_contacts(mesh).pairs, 1U);
}

TEST(SelfContact, DoesNotCountBodiesNestedWithoutContact) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, {0, 0, 0}, 10);
  add_tetrahedron(mesh, {1, 1, 1}, 1);
  EXPECT_EQ(count_self_contacts(mesh).pairs, 0U);
}

}  // namespace
}  // namespace meso
