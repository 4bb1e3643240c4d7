// SPDX-License-Identifier: Apache-2.0
#pragma once
// Meshes with known distances, and a source of points, for tests of this room.

#include <algorithm>
#include <cmath>
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

inline double facet_sagitta(const TriangleMesh& mesh) {
  double most = 0;  // how far a facet's plane is inside the ball
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const Vec3 n = cross(b - a, c - a);
    most = std::max(most, 1 - dot(a, n) / norm(n));
  }
  return most;
}

inline TriangleMesh box_mesh(Vec3 low, Vec3 high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.push_back(
        {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline double box_distance(Vec3 low, Vec3 high, Vec3 p) {
  Vec3 q;
  for (std::size_t i = 0; i < 3; ++i) q[i] = std::max(low[i] - p[i], p[i] - high[i]);
  const Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return norm(out) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

inline TriangleMesh moved(TriangleMesh mesh, const Affine& map) {
  for (Vec3& p : mesh.points) p = map * p;
  return mesh;
}

inline TriangleMesh inverted(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

/// A ring of `teeth` thin spikes, up and down in turn, over and under one saddle-shaped middle: sharp, not convex, and
/// at its middle a vertex whose faces point every way.
inline TriangleMesh spiky_saddle(int teeth) {
  TriangleMesh mesh{{{0, 0, 0.05}, {0, 0, -0.05}}, {}};
  for (int i = 0; i < 2 * teeth; ++i) {
    const double angle = 3.14159265358979 * i / teeth, r = i % 2 == 0 ? 1 : 0.1,
                 z = i % 4 == 0   ? 0.6
                     : i % 2 == 0 ? -0.6
                                  : 0;
    mesh.points.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  const auto rim = [&](int i) { return static_cast<std::uint32_t>(2 + i % (2 * teeth)); };
  for (int i = 0; i < 2 * teeth; ++i) {
    mesh.triangles.push_back({0, rim(i), rim(i + 1)});
    mesh.triangles.push_back({1, rim(i + 1), rim(i)});
  }
  return mesh;
}

/// The sum of solid angles over 4 pi, triangle by triangle in long double: another way to know inside from outside.
inline double solid_angle_winding(const TriangleMesh& mesh, Vec3 p) {
  using Real = long double;
  struct V {
    Real x, y, z;
    [[nodiscard]] Real dot(const V& b) const { return x * b.x + y * b.y + z * b.z; }
  };
  Real sum = 0;
  for (const auto& t : mesh.triangles) {
    std::array<V, 3> v;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 q = mesh.points[t[i]];
      v[i] = {Real(q.x) - p.x, Real(q.y) - p.y, Real(q.z) - p.z};
    }
    const auto& [a, b, c] = v;
    const V bc{b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x};
    const Real la = std::sqrt(a.dot(a)), lb = std::sqrt(b.dot(b)), lc = std::sqrt(c.dot(c));
    sum += std::atan2(a.dot(bc), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return static_cast<double>(sum / (2 * 3.14159265358979323846L));
}

/// Distance to one triangle in long double: the nearest point of its edges and, where it is inside, the foot.
inline long double slow_distance(const TriangleMesh& mesh, std::size_t triangle, Vec3 point) {
  using Real = long double;
  using V = std::array<Real, 3>;
  const auto minus = [](const V& a, const V& b) { return V{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto dot = [](const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto cross = [](const V& a, const V& b) {
    return V{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  std::array<V, 3> t;  // corners as seen from the point
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 q = mesh.points[mesh.triangles[triangle][i]];
    t[i] = {Real(q.x) - point.x, Real(q.y) - point.y, Real(q.z) - point.z};
  }
  Real best = HUGE_VALL;
  for (std::size_t i = 0; i < 3; ++i) {
    const V a = t[i], edge = minus(t[(i + 1) % 3], a);
    const Real length2 = dot(edge, edge);
    const Real s = length2 > 0 ? std::clamp(-dot(a, edge) / length2, Real(0), Real(1)) : Real(0);
    const V q{a[0] + s * edge[0], a[1] + s * edge[1], a[2] + s * edge[2]};
    best = std::min(best, std::sqrt(dot(q, q)));
  }
  // The foot as a point of the triangle, in four steps: the plane of a needle is known to few digits.
  const V u = minus(t[1], t[0]), v = minus(t[2], t[0]), n = cross(u, v);
  const Real n2 = dot(n, n);
  V rest{-t[0][0], -t[0][1], -t[0][2]};
  Real weight_u = 0, weight_v = 0;
  for (int step = 0; step < 4 && n2 > 0; ++step) {
    const Real du = dot(cross(rest, v), n) / n2, dv = dot(cross(u, rest), n) / n2;
    weight_u += du;
    weight_v += dv;
    for (std::size_t i = 0; i < 3; ++i) rest[i] -= du * u[i] + dv * v[i];
    if (weight_u >= 0 && weight_v >= 0 && weight_u + weight_v <= 1) best = std::min(best, std::sqrt(dot(rest, rest)));
  }
  return best;
}

inline long double slow_distance(const TriangleMesh& mesh, Vec3 point) {
  long double best = HUGE_VALL;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) best = std::min(best, slow_distance(mesh, i, point));
  return best;
}

}  // namespace meso::implicit
