// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/closest_point.hpp"

#include <algorithm>

namespace meso {
namespace {

/// The point of the segment from 0 to `edge` that is nearest to p. No division by zero; 0 where the segment is a point.
Vec3 closest_on_edge(Vec3 edge, Vec3 p) {
  const double along = dot(edge, p), length2 = dot(edge, edge);
  if (!(along > 0)) return {};
  return along < length2 ? (along / length2) * edge : edge;
}

}  // namespace

Vec3 to_closest_point(const Triangle& t, Vec3 p) {
  // Offsets from corner a: what is computed depends on the triangle's size and its distance, not on where they are.
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const Vec3 n = cross(ab, ac);
  const double n2 = dot(n, n);
  // Barycentric weights of the foot of p on the plane, times n2.
  const double b = dot(cross(ap, ac), n), c = dot(cross(ab, ap), n), a = n2 - b - c;
  const bool foot_inside = n2 > 0 && a >= 0 && b >= 0 && c >= 0;
  // n2 = (longest edge * height)^2. Where the height is much smaller than the edge, rounding turns the normal, and the
  // weights with it: then the foot is approached in steps, and edges may be nearer.
  const double size2 = std::max(dot(ab, ab), dot(ac, ac));
  const bool slender = !(n2 > 1e-4 * size2 * size2);
  Vec3 from_best = ap;
  double best2 = HUGE_VAL;
  const auto consider = [&](Vec3 q) {
    const Vec3 d = ap - q;
    const double d2 = dot(d, d);
    if (d2 < best2) from_best = d, best2 = d2;
  };
  if (foot_inside && !slender) consider((b / n2) * ab + (c / n2) * ac);
  if (n2 > 0 && slender) {
    // Each step leaves a fraction of the one before it, of about rounding over the sine of the sharp angle.
    double v = 0, w = 0;
    Vec3 rest = ap;
    for (int step = 0; step < 4; ++step) {
      v += dot(cross(rest, ac), n) / n2;
      w += dot(cross(ab, rest), n) / n2;
      const Vec3 foot = v * ab + w * ac;
      if (v >= 0 && w >= 0 && v + w <= 1) consider(foot);
      rest = ap - foot;
    }
  }
  // From outside, only edges that the foot is beyond are seen; the nearest point is on one of them.
  if (slender || c < 0) consider(closest_on_edge(ab, ap));
  if (slender || b < 0) consider(closest_on_edge(ac, ap));
  if (slender || a < 0) consider(ab + closest_on_edge(ac - ab, ap - ab));
  return -from_best;
}

}  // namespace meso
