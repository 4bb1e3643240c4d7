// SPDX-License-Identifier: Apache-2.0
#pragma once
// A cross-section: closed polylines in a plane.

#include <array>
#include <vector>

namespace meso {

struct Slice {
  double height = 0;  ///< along the third axis, millimetres
  /// Closed without repeating the first point; the solid is on the left.
  std::vector<std::vector<std::array<double, 2>>> loops;

  /// Of the solid, mm^2.
  [[nodiscard]] double area() const {
    double twice = 0;
    for (const auto& loop : loops)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto &p = loop[i], &q = loop[(i + 1) % loop.size()];
        twice += p[0] * q[1] - p[1] * q[0];
      }
    return twice / 2;
  }
};

}  // namespace meso
