// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/self_contact.hpp"

#include <gtest/gtest.h>

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
  EXPECT_TRUE(found.first_place.has_value());
  EXPECT_EQ(count_self_contacts(mesh, 1).pairs, 1U);
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
