// SPDX-License-Identifier: Apache-2.0
#pragma once
// Linear interpolation between the nodes of a grid of one to three axes.
//
//   const GridInterpolation grid({{0, 1, 2}, {0, 10}});   // rows: first axis outermost, last fastest
//   grid.at(std::array{0.5, 5.0});                         // four rows, weight 1/4 each; nothing outside of the grid
//
// Exact at the nodes (within 1e-12 of a step). An axis with one node is constant along it. Immutable; safe to share.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "meso/fields/stencil.hpp"

namespace meso::fields {

inline constexpr std::size_t most_grid_axes = 3;

class GridInterpolation {
 public:
  /// REQUIRES: one to three axes, each with nodes that ascend strictly.
  explicit GridInterpolation(std::vector<std::vector<double>> axes);

  [[nodiscard]] const std::vector<std::vector<double>>& axes() const { return axes_; }
  /// Within the grid, or within 1e-12 of a step of it.
  [[nodiscard]] bool contains(std::span<const double> q) const;
  /// REQUIRES: as many coordinates as axes. Coordinates outside are taken to the nearest side.
  [[nodiscard]] Stencil at(std::span<const double> q) const;
  /// The derivative of a column along each axis: differences of the nodes on both sides (of one at the ends), second
  /// order also on unequal steps as numpy.gradient has them, interpolated linearly. 0 along an axis with one node.
  [[nodiscard]] std::array<double, most_grid_axes> derivative(const Records& records, std::size_t column,
                                                              const Stencil& stencil) const;

 private:
  struct Place {
    std::size_t node = 0;
    double fraction = 0;
  };
  [[nodiscard]] Place place(std::size_t axis, double q) const;

  std::vector<std::vector<double>> axes_;
  std::vector<std::int64_t> step_;  ///< rows from one node of an axis to its next
};

}  // namespace meso::fields
