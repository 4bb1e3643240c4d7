// SPDX-License-Identifier: Apache-2.0
#include "lattice/mesh_probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double far = 4;          ///< radii of a group
constexpr std::size_t crowd = 64;  ///< triangles of a group; more are halved

/// Twice the tangent of the quarter is avoided: van Oosterom & Strackee 1983.
double solid_angle(const Triangle3& triangle, Vec3 p) {
  const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

double distance_to(const Triangle3& t, Vec3 p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return norm(ap);
  const Vec3 bp = p - t[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return norm(bp);
  const Vec3 cp = p - t[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return norm(cp);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return norm(ap - d1 / (d1 - d3) * ab);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return norm(ap - d2 / (d2 - d6) * ac);
  if (va <= 0 && d4 >= d3 && d5 >= d6) return norm(bp - (d4 - d3) / (d4 - d3 + d5 - d6) * (t[2] - t[1]));
  const double all = va + vb + vc;
  return norm(ap - vb / all * ab - vc / all * ac);
}

double distance_to(std::span<const Triangle3> triangles, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle3& triangle : triangles) least = std::fmin(least, distance_to(triangle, p));
  return least;
}

void MeshProbe::add_group(std::vector<Triangle3> triangles) {
  if (triangles.size() > crowd) {
    const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
    Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
    for (const Triangle3& t : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::fmin(low[i], t[0][i]);
        high[i] = std::fmax(high[i], t[0][i]);
      }
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
    std::nth_element(triangles.begin(), middle, triangles.end(),
                     [axis](const Triangle3& a, const Triangle3& b) { return a[0][axis] < b[0][axis]; });
    add_group({triangles.begin(), middle});
    add_group({middle, triangles.end()});
    return;
  }
  Group group{std::move(triangles), {}, {}, 0};
  double weight = 0;
  for (const Triangle3& t : group.triangles) {
    const Vec3 area = 0.5 * cross(t[1] - t[0], t[2] - t[0]);
    group.area += area;
    group.centre += norm(area) / 3 * (t[0] + t[1] + t[2]);
    weight += norm(area);
  }
  if (weight == 0) return;
  group.centre = group.centre / weight;
  for (const Triangle3& t : group.triangles)
    for (const Vec3 p : t) group.radius = std::fmax(group.radius, norm(p - group.centre));
  groups_.push_back(std::move(group));
}

bool MeshProbe::contains(Vec3 p) const {
  double angle = 0;
  for (const Group& group : groups_) {
    const Vec3 to = group.centre - p;
    const double distance = norm(to);
    if (distance > far * group.radius) {
      angle += dot(group.area, to) / (distance * distance * distance);
      continue;
    }
    for (const Triangle3& triangle : group.triangles) angle += solid_angle(triangle, p);
  }
  return angle > 2 * std::numbers::pi;
}

}  // namespace meso::brep
