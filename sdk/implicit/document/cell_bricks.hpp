// SPDX-License-Identifier: Apache-2.0
#pragma once
// Samples of placed cells on a grid. Private.

#include <memory>

#include "placed_cells.hpp"

namespace meso::implicit {

/// Empty if the run was stopped.
[[nodiscard]] std::unique_ptr<ExternalField::Prepared> prepare_bricks(std::shared_ptr<const PlacedCells> cells,
                                                                      const Grid& grid, const Affine& field_from_grid,
                                                                      double band, const RunOptions& run);

}  // namespace meso::implicit
