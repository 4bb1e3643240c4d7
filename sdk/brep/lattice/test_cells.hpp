// SPDX-License-Identifier: Apache-2.0
#pragma once
// The unit cell that tests of lattices share.

#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

constexpr double bcc_cell = 22.928246067499;  ///< volume of bcc() in its box, by inclusion and exclusion

/// Body-centred: a = 5, r = 0.5, R = 0.9.
inline LatticeCell bcc() {
  LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Ball{{2.5, 2.5, 2.5}, 0.9}}};
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 5.0 : 0, i & 2 ? 5.0 : 0, i & 4 ? 5.0 : 0};
    cell.primitives.push_back(Ball{corner, 0.9});
    cell.primitives.push_back(Frustum{corner, {2.5, 2.5, 2.5}, 0.5, 0.5});
  }
  return cell;
}

}  // namespace meso::brep
