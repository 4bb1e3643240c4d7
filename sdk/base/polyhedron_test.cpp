// SPDX-License-Identifier: Apache-2.0
// Polyhedra with known volumes, and every way not to be one.
#include "meso/base/polyhedron.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace meso {
namespace {

Polyhedron cube(Vec3 corner, double edge) {
  Polyhedron p;
  for (int z = 0; z < 2; ++z)
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      p.vertices.push_back(corner + edge * Vec3{double(x), double(y), double(z)});
  p.faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return p;
}

Polyhedron turned(Polyhedron p) {
  for (auto& face : p.faces) std::reverse(face.begin(), face.end());
  return p;
}

Polyhedron together(Polyhedron a, const Polyhedron& b) {
  const std::size_t first = a.vertices.size();
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto face : b.faces) {
    for (std::size_t& v : face) v += first;
    a.faces.push_back(face);
  }
  return a;
}

std::vector<std::size_t> all_faces(const Polyhedron& p) {
  std::vector<std::size_t> faces(p.faces.size());
  std::iota(faces.begin(), faces.end(), std::size_t{0});
  return faces;
}

void expect_fault(const Polyhedron& p, Code code, std::size_t face, std::vector<std::string> args) {
  const auto fault = polyhedron_fault(p);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, code);
  EXPECT_EQ(fault->face, face);
  EXPECT_EQ(fault->args, args);
}

TEST(Polyhedra, ACubeIsOne) {
  const Polyhedron p = cube({1000, 2000, -3000}, 3);
  EXPECT_FALSE(polyhedron_fault(p));
  EXPECT_DOUBLE_EQ(volume_of(p, all_faces(p)), 27);
  EXPECT_NEAR(winding_of(p, all_faces(p), {1001, 2002, -2999}), 1, 1e-12);
  EXPECT_NEAR(winding_of(p, all_faces(p), {1004, 2002, -2999}), 0, 1e-12);
  EXPECT_DOUBLE_EQ(plane_of(p, 1).offset, -2997);
}

TEST(Polyhedra, CavitiesAndSeparateBodiesAreOnes) {
  const Polyhedron shell = together(cube({0, 0, 0}, 4), turned(cube({1, 1, 1}, 2)));
  EXPECT_FALSE(polyhedron_fault(shell));
  EXPECT_DOUBLE_EQ(volume_of(shell, all_faces(shell)), 56);
  EXPECT_EQ(shells_of(shell), (std::vector<std::size_t>{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}));
  EXPECT_FALSE(polyhedron_fault(together(shell, cube({1.5, 1.5, 1.5}, 1))));
  EXPECT_FALSE(polyhedron_fault(together(shell, cube({9, 0, 0}, 1))));
}

TEST(Polyhedra, ConcaveFacesAreFaces) {
  Polyhedron p;  // an arrowhead drawn out
  for (const double z : {0.0, 2.0})
    for (const auto& [x, y] : {std::pair{0, 0}, {4, 0}, {1, 1}, {0, 4}})
      p.vertices.push_back({double(x), double(y), z});
  p.faces = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  EXPECT_FALSE(polyhedron_fault(p));
  EXPECT_DOUBLE_EQ(volume_of(p, all_faces(p)), 8);
}

TEST(Polyhedra, BadFaces) {
  Polyhedron p = cube({0, 0, 0}, 1);
  p.faces[2] = {0, 1, 8, 4};
  expect_fault(p, Code::polyhedron_index, 2, {"vertex 8, but there are only 8, counted from 0"});
  p.faces[2] = {0, 1, 5, 1};
  expect_fault(p, Code::polyhedron_index, 2, {"vertex 1 twice"});
  p.faces[2] = {0, 1, 4, 5};
  expect_fault(p, Code::polyhedron_face, 2, {"has no area"});
  p.faces[2] = {0, 1};
  expect_fault(p, Code::polyhedron_face, 2, {"has fewer than three corners"});
  p = cube({0, 0, 0}, 1);
  p.vertices[6] = {1, 1, 1.5};
  expect_fault(p, Code::polyhedron_face, 1, {"is not plane: vertex 4 is 0.118 off"});
  p.vertices[6] = {1, 1, 1 + 1e-7};  // within the tolerance
  EXPECT_FALSE(polyhedron_fault(p));
}

TEST(Polyhedra, OpenOnes) {
  Polyhedron p = cube({0, 0, 0}, 1);
  p.faces.pop_back();
  expect_fault(p, Code::polyhedron_not_closed, 0, {"0", "3", "belongs to this face alone"});
  p = cube({0, 0, 0}, 1);
  std::reverse(p.faces[4].begin(), p.faces[4].end());
  expect_fault(p, Code::polyhedron_not_closed, 4, {"3", "2", "is run along in this direction by another face too"});
}

TEST(Polyhedra, InsideOut) {
  expect_fault(turned(cube({0, 0, 0}, 1)), Code::polyhedron_inside_out, 0, {});
  expect_fault(together(cube({0, 0, 0}, 4), cube({1, 1, 1}, 2)), Code::polyhedron_inside_out, 6, {});
  expect_fault(together(cube({0, 0, 0}, 4), turned(cube({9, 1, 1}, 2))), Code::polyhedron_inside_out, 6, {});
}

TEST(Polyhedra, ThatCrossThemselves) {
  expect_fault(together(cube({0, 0, 0}, 4), cube({2, 2, 2}, 4)), Code::polyhedron_crosses, 1, {"8, 9, 13, 12"});
  // Side by side they meet too: of two faces in one plane one lies on the other.
  expect_fault(together(cube({0, 0, 0}, 4), cube({4, 1, 1}, 2)), Code::polyhedron_crosses, 3, {"8, 11, 10, 9"});
  // A corner through a face, though every face is plane and every edge used twice.
  Polyhedron spike;
  spike.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 3}, {2, -1, 1}};
  spike.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_FALSE(polyhedron_fault(spike));
  spike.vertices.push_back({1, 1, 0.5});
  spike.faces = {{0, 2, 4}, {2, 1, 4}, {1, 0, 4}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  expect_fault(spike, Code::polyhedron_crosses, 0, {"0, 1, 3"});
}

}  // namespace
}  // namespace meso
