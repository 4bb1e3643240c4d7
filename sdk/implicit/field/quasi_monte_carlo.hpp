// SPDX-License-Identifier: Apache-2.0
#pragma once
// Shares of volume by counting points that fill a box evenly and lie on no lattice plane of it. Part of tests.

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// Values of a field at `count` points of a box, point by point.
class QuasiMonteCarlo {
 public:
  explicit QuasiMonteCarlo(const Box3& box) : box_(box) {}

  /// Calls back with spans of values until all points are done.
  template <class F>
  void sample(const Field& field, std::size_t count, F f) const {
    // Kronecker's sequence with the powers of 1/g, g^4 = g + 1: the plastic number's kin in three dimensions.
    constexpr double g = 1.2207440846057596;
    const Vec3 step{1 / g, 1 / (g * g), 1 / (g * g * g)};
    std::vector<Vec3> points;
    std::vector<double> values;
    for (std::size_t first = 0; first < count; first += points.size()) {
      points.resize(std::min<std::size_t>(4096, count - first));
      values.resize(points.size());
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double t = 0.5 + step[axis] * static_cast<double>(first + i + 1);
          points[i][axis] = box_.min[axis] + (t - std::floor(t)) * (box_.max[axis] - box_.min[axis]);
        }
      field.values(points, values);
      f(std::span<const double>(values));
    }
  }

  /// Volume of {f < 0} within the box.
  [[nodiscard]] double volume(const Field& field, std::size_t count) const {
    std::size_t inside = 0;
    sample(field, count, [&](std::span<const double> values) {
      for (const double v : values) inside += v < 0 ? 1 : 0;
    });
    const Vec3 size = box_.max - box_.min;
    return size.x * size.y * size.z * static_cast<double>(inside) / static_cast<double>(count);
  }

 private:
  Box3 box_;
};

}  // namespace meso::implicit
