// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where an instance of a template stands: lattice translation first, the shell's placement after it.

#include "meso/brep/body.hpp"

namespace meso::brep {

/// lattice * cell, in the template's frame. The same cell gives the same bits.
[[nodiscard]] inline Vec3 cell_origin(const Template& geometry, const Index3& cell) {
  return geometry.lattice *
         Vec3{static_cast<double>(cell[0]), static_cast<double>(cell[1]), static_cast<double>(cell[2])};
}

/// One shell that visits every face of `geometry` once, in cell (0, 0, 0).
[[nodiscard]] inline Shell whole_template(std::shared_ptr<const Template> geometry, const Affine& placement = {}) {
  const auto visit = [faces = static_cast<std::uint32_t>(geometry->faces.size())](const auto& callback) {
    for (std::uint32_t face = 0; face < faces; ++face) callback({face, {0, 0, 0}});
  };
  return {std::move(geometry), placement, visit};
}

}  // namespace meso::brep
