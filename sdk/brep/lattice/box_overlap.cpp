// SPDX-License-Identifier: Apache-2.0
#include "lattice/box_overlap.hpp"

#include <algorithm>
#include <cmath>

namespace meso::brep {
namespace {

double reach(Vec3 axis, Vec3 half) {
  return std::fabs(axis.x) * half.x + std::fabs(axis.y) * half.y + std::fabs(axis.z) * half.z;
}

bool separated(Vec3 axis, const Triangle3& t, Vec3 half) {
  const double a = dot(axis, t[0]), b = dot(axis, t[1]), c = dot(axis, t[2]), r = reach(axis, half);
  return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
}

}  // namespace

bool overlaps(const Triangle3& triangle, Vec3 centre, Vec3 half) {
  const Triangle3 t{triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
  const std::array<Vec3, 3> edges{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3 axis{};
    axis[i] = 1;
    if (separated(axis, t, half)) return false;
    for (const Vec3& edge : edges)
      if (separated(cross(axis, edge), t, half)) return false;
  }
  return !separated(cross(edges[0], edges[1]), t, half);
}

double plane_gap(Vec3 normal, double offset, Vec3 centre, Vec3 half) {
  return std::fabs(dot(normal, centre) - offset) - reach(normal, half);
}

std::optional<std::pair<Vec3, Vec3>> clipped(Vec3 from, Vec3 to, Vec3 centre, Vec3 half) {
  double enter = 0, leave = 1;
  const Vec3 p = from - centre, d = to - from;
  for (std::size_t i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (std::fabs(p[i]) > half[i]) return {};
      continue;
    }
    const double a = (-half[i] - p[i]) / d[i], b = (half[i] - p[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return {};
  return std::pair(from + enter * d, from + leave * d);
}

}  // namespace meso::brep
