// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bodies whose measures are known in closed form, for the tests of this room.

#include <string>
#include <vector>

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct ClosedForm {
  std::string name;
  TopoDS_Shape shape;
  double volume = 0, area = 0;
  Vec3 centroid;
  double tolerance = 1e-9;  ///< relative
};
[[nodiscard]] std::vector<ClosedForm> closed_forms();

/// The template of bodies made of lattice cells as oblique voxels: one vertex, three edges, six faces a cell.
[[nodiscard]] Template voxel_template(const Mat3& lattice);

/// The cells of [0, size) that are solid, and how many they are.
struct Voxels {
  Body body;
  std::int64_t count = 0;
};
[[nodiscard]] Voxels voxels(const Mat3& lattice, Index3 size, const std::function<bool(Index3)>& solid);

/// Bars along the three axes through every second cell: a cubic truss.
[[nodiscard]] inline bool is_bar(Index3 c) { return (c[0] % 2 == 0) + (c[1] % 2 == 0) + (c[2] % 2 == 0) >= 2; }

}  // namespace meso::brep
