// SPDX-License-Identifier: Apache-2.0
#pragma once
// The nodes at which a field is sampled: a box, both ends included, and a number of nodes along each axis.
//
//   Grid grid{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {800, 800, 800}};   // 799 cells along each axis
//   grid.coordinate(0, 799) == 1

#include <array>
#include <cstdint>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/vec.hpp"

namespace meso::implicit {

struct Grid {
  Box3 box;
  std::array<std::int32_t, 3> nodes{2, 2, 2};  ///< at least 2 each

  /// Never accumulated, and the last node is the box's end to the bit. REQUIRES: 0 <= i < nodes[axis].
  [[nodiscard]] double coordinate(std::size_t axis, std::int32_t i) const {
    const std::int32_t last = nodes[axis] - 1;
    return i == last ? box.max[axis] : box.min[axis] + (box.max[axis] - box.min[axis]) * i / last;
  }
  [[nodiscard]] Vec3 node(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return {coordinate(0, i), coordinate(1, j), coordinate(2, k)};
  }
  [[nodiscard]] double spacing(std::size_t axis) const { return (box.max[axis] - box.min[axis]) / (nodes[axis] - 1); }
  [[nodiscard]] std::uint64_t node_count() const {
    return std::uint64_t(nodes[0]) * std::uint64_t(nodes[1]) * std::uint64_t(nodes[2]);
  }
};

/// About `total` nodes over a box, as near to cubes as whole numbers allow: n_i = L_i (total / L_x L_y L_z)^(1/3),
/// rounded, at least 2; what one axis takes beyond its share the longer ones do without. REQUIRES: a box of positive
/// size.
[[nodiscard]] std::array<std::int32_t, 3> nodes_for_total(const Box3& box, double total);

/// On which sides of the box a point stands: bits 0 and 1 are the two across x, 2 and 3 those across y.
[[nodiscard]] unsigned planes_of(const Box3& box, Vec3 p);
/// What is left of a vector in these planes.
[[nodiscard]] Vec3 within(unsigned planes, Vec3 v);

/// Whether work on a grid that takes so many bytes is within the budget; LIMIT_GRID_MEMORY, with what it takes them
/// for, where it is not.
[[nodiscard]] bool fits_memory(const Grid& grid, std::uint64_t bytes, std::string_view purpose, const RunOptions& run,
                               DiagnosticSink& diagnostics);
/// The same of nodes that stand otherwise; `nodes` is how many.
[[nodiscard]] bool fits_memory(std::string nodes, std::uint64_t bytes, std::string_view purpose, const RunOptions& run,
                               DiagnosticSink& diagnostics);
/// Whole ones, for people.
[[nodiscard]] std::string mebibytes(std::uint64_t bytes);

/// The step of a box's largest coordinate, as a float.
[[nodiscard]] double float_step(const Box3& box);

}  // namespace meso::implicit
