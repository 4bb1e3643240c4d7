// SPDX-License-Identifier: Apache-2.0
#pragma once
// Samples of placed cells on a grid. Private.

#include <memory>

#include "placed_cells.hpp"

namespace meso::implicit {

[[nodiscard]] std::unique_ptr<ExternalField::Prepared> prepare_bricks(std::shared_ptr<const PlacedCells> cells,
                                                                      const Grid& grid, const Affine& field_from_grid,
                                                                      double band);

}  // namespace meso::implicit
