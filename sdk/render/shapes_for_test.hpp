// SPDX-License-Identifier: Apache-2.0
#pragma once
// Meshes whose picture is known beforehand.

#include <cmath>
#include <numbers>

#include "meso/base/triangle_mesh.hpp"

namespace meso::picture {

/// Every triangle with its own three points, as an STL file has them.
inline void add_triangle(TriangleMesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

inline TriangleMesh box_soup(Vec3 min, Vec3 max) {
  TriangleMesh mesh;
  const auto corner = [&](int i) { return Vec3{i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z}; };
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    add_triangle(mesh, corner(f[0]), corner(f[1]), corner(f[2]));
    add_triangle(mesh, corner(f[0]), corner(f[2]), corner(f[3]));
  }
  return mesh;
}

inline TriangleMesh sphere_soup(double radius, int rings) {
  TriangleMesh mesh;
  const auto at = [&](int ring, int sector) {
    const double polar = std::numbers::pi * ring / rings;
    const double turn = std::numbers::pi * (sector % (2 * rings)) / rings;
    if (ring == 0 || ring == rings) return Vec3{0, 0, ring == 0 ? radius : -radius};
    return radius * Vec3{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      if (i > 0) add_triangle(mesh, at(i, j), at(i + 1, j), at(i, j + 1));
      if (i < rings - 1) add_triangle(mesh, at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  return mesh;
}

}  // namespace meso::picture
