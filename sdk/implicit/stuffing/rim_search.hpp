// SPDX-License-Identifier: Apache-2.0
#pragma once
// From points in planes of the box to where the surface meets these planes. Private.

#include <span>

#include "meso/implicit/grid_source.hpp"
#include "meso/implicit/stuffing.hpp"

namespace meso::implicit::stuffing {

struct Rim {
  Vec3 from;
  unsigned planes = 0;  ///< as planes_of() has them: it is looked for in these
  Vec3 at{};            ///< on the inside, to a millionth of the spacing
  bool from_inside = false, is_found = false;
};

/// Down the field's slope in the planes, or where it has none towards where its sign changes; no farther than nine
/// tenths of the spacing. About 30 values a rim, asked of all together; 600 where it has none.
void find_rims(std::span<Rim> rims, GridSampler& sampler, const BccLattice& lattice);

}  // namespace meso::implicit::stuffing
