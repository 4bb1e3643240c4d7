// SPDX-License-Identifier: Apache-2.0
#include "winding.hpp"

#include <numbers>

namespace meso::operations {
namespace {

/// Half the signed solid angle of a triangle seen from the origin.
double half_solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double triple = dot(a, cross(b, c));
  return std::atan2(triple, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

std::vector<bool> inside_by_winding(const TriangleStream& triangles, std::span<const Vec3> points) {
  std::vector<double> sums(points.size(), 0.0);
  triangles([&](std::span<const Triangle> block) {
    for (const Triangle& t : block) {
      for (std::size_t i = 0; i < points.size(); ++i)
        sums[i] += half_solid_angle(t[0] - points[i], t[1] - points[i], t[2] - points[i]);
    }
  });
  std::vector<bool> inside;
  for (const double sum : sums) inside.push_back(std::abs(sum) > std::numbers::pi);  // 2 pi inside, 0 outside
  return inside;
}

}  // namespace meso::operations
