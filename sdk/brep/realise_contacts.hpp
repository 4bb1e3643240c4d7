// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which placed cells touch or overlap each other? Private.

#include <cstdint>
#include <vector>

#include "realise_cells.hpp"

namespace meso::brep {

/// Cells that touch, directly or through others, are one cluster.
struct Clusters {
  std::vector<std::uint32_t> of_cell;  ///< the smallest index of a cell in the same cluster
  std::vector<std::uint32_t> sizes;    ///< by that index

  [[nodiscard]] bool is_alone(std::size_t cell) const { return sizes[of_cell[cell]] == 1; }
};

/// Of the cells that are `taken`. Bodies closer than clear_distance touch. Pairs are found by a grid of boxes; each way
/// in which two cells can stand to each other is decided once. May throw Standard_Failure.
[[nodiscard]] Clusters clusters_of(const CellSolids& cells, const std::vector<bool>& taken);

}  // namespace meso::brep
