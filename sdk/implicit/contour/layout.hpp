// SPDX-License-Identifier: Apache-2.0
#pragma once
// Sizes and coordinates that every part of one contouring run shares.
//
// The grid is thought to lie in one more layer of nodes that are outside: this closes the surface at the box. Cell b of
// a row lies between the nodes b - 1 and b, b = 0 ... nodes; so does edge b along x. Rows and planes count alike: cell
// row (j, k) lies between rows j - 1 and j of the planes k - 1 and k. An added node has the coordinate of the node it
// adds to, so that a vertex on an edge between the two stands exactly in the box's plane.

#include <cmath>
#include <vector>

#include "meso/implicit/grid.hpp"

namespace meso::implicit {

struct Layout {
  explicit Layout(const Grid& grid)
      : nx(static_cast<std::size_t>(grid.nodes[0])),
        ny(static_cast<std::size_t>(grid.nodes[1])),
        nz(static_cast<std::size_t>(grid.nodes[2])),
        words(nx / 64 + 1),
        x_(padded(grid, 0)),
        y_(padded(grid, 1)),
        z_(padded(grid, 2)) {}

  /// i = -1 ... nodes.
  [[nodiscard]] double x(std::ptrdiff_t i) const { return x_[static_cast<std::size_t>(i + 1)]; }
  [[nodiscard]] double y(std::ptrdiff_t j) const { return y_[static_cast<std::size_t>(j + 1)]; }
  [[nodiscard]] double z(std::ptrdiff_t k) const { return z_[static_cast<std::size_t>(k + 1)]; }

  /// Twice the area of a triangle that faces nowhere.
  [[nodiscard]] double least_facing() const {
    return 1e-6 * std::pow((x(1) - x(0)) * (y(1) - y(0)) * (z(1) - z(0)), 2.0 / 3);
  }

  std::size_t nx, ny, nz;
  std::size_t words;  ///< of a row of cells

 private:
  static std::vector<double> padded(const Grid& grid, std::size_t axis) {
    const std::int32_t n = grid.nodes[axis];
    std::vector<double> c(static_cast<std::size_t>(n) + 2);
    for (std::int32_t i = 0; i < n; ++i) c[static_cast<std::size_t>(i) + 1] = grid.coordinate(axis, i);
    c.front() = c[1];
    c.back() = c[static_cast<std::size_t>(n)];
    return c;
  }

  std::vector<double> x_, y_, z_;
};

}  // namespace meso::implicit
