// SPDX-License-Identifier: Apache-2.0
#pragma once
// Meshes with known distances, and a source of points, for tests of this room.

#include <map>
#include <random>

#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  Vec3 in_cube(double half) { return {in(-half, half), in(-half, half), in(-half, half)}; }

 private:
  std::mt19937_64 engine_;
};

/// Radius 1; every subdivision parts each of 20 triangles into four.
inline TriangleMesh icosphere(int subdivisions) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh{{{-1, g, 0},
                     {1, g, 0},
                     {-1, -g, 0},
                     {1, -g, 0},
                     {0, -1, g},
                     {0, 1, g},
                     {0, -1, -g},
                     {0, 1, -g},
                     {g, 0, -1},
                     {g, 0, 1},
                     {-g, 0, -1},
                     {-g, 0, 1}},
                    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.points.size()));
      if (added) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.points) p = p / norm(p);
  return mesh;
}

/// How far the middle of the largest facet is below the ball: its circumradius c gives 1 - sqrt(1 - c^2).
inline double facet_sagitta(const TriangleMesh& mesh) {
  double most = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const Vec3 n = cross(b - a, c - a);
    most = std::max(most, 1 - dot(a, n) / norm(n));
  }
  return most;
}

}  // namespace meso::implicit
