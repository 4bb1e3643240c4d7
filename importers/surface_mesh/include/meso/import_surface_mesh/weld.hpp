// SPDX-License-Identifier: Apache-2.0
#pragma once
// Builds an indexed mesh from loose corners.
//
//   Weld weld;
//   weld.add(a, b, c);                      // corners counter-clockwise from outside
//   TriangleMesh mesh = std::move(weld).mesh();
//
// Corners that are equal (0 and -0 are) become one point, numbered by first appearance. At most 2^32 - 1 points.

#include "meso/base/triangle_mesh.hpp"

namespace meso {

class Weld {
 public:
  void reserve(std::size_t triangles);
  void add(Vec3 a, Vec3 b, Vec3 c);
  [[nodiscard]] TriangleMesh mesh() && { return std::move(mesh_); }

 private:
  [[nodiscard]] std::uint32_t index_of(Vec3 point);
  void rehash(std::size_t slots);

  TriangleMesh mesh_;
  std::vector<std::uint32_t> slots_;  // open addressing; index + 1 of a point, 0 is free
};

}  // namespace meso
