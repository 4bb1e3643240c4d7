// SPDX-License-Identifier: Apache-2.0
#include "plane_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace meso::implicit {
namespace {

struct Eigen {
  Vec3 values;
  Mat3 vectors;  ///< columns
};

// Jacobi's rotations: for three by three, half a dozen sweeps reach the last bits.
Eigen eigen_of(Mat3 a) {
  Mat3 v;
  for (int sweep = 0; sweep < 12; ++sweep) {
    if (a(0, 1) * a(0, 1) + a(0, 2) * a(0, 2) + a(1, 2) * a(1, 2) == 0) break;
    for (const auto& [p, q] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
      if (a(p, q) == 0) continue;
      const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
      const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      const auto rotate = [&](double& x, double& y) {
        const double old = x;
        x = c * old - s * y;
        y = s * old + c * y;
      };
      for (std::size_t k = 0; k < 3; ++k) rotate(a(k, p), a(k, q));
      for (std::size_t k = 0; k < 3; ++k) rotate(a(p, k), a(q, k));
      for (std::size_t k = 0; k < 3; ++k) rotate(v(k, p), v(k, q));
      a(p, q) = a(q, p) = 0;
    }
  }
  return {{a(0, 0), a(1, 1), a(2, 2)}, v};
}

}  // namespace

Vec3 nearest_to_planes(std::span<const Plane> planes, Vec3 start, double least_share) {
  Mat3 sum{{0, 0, 0, 0, 0, 0, 0, 0, 0}};
  Vec3 right;
  for (const Plane& plane : planes) {
    const double distance = dot(plane.normal, start - plane.at) + plane.value;
    right += -distance * plane.normal;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) sum(r, c) += plane.normal[r] * plane.normal[c];
  }
  const Eigen eigen = eigen_of(sum);
  const double largest = std::max({eigen.values.x, eigen.values.y, eigen.values.z});
  Vec3 point = start;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(eigen.values[k] > least_share * largest)) continue;
    const Vec3 direction = eigen.vectors.column(k);
    point += dot(direction, right) / eigen.values[k] * direction;
  }
  return point;
}

}  // namespace meso::implicit
