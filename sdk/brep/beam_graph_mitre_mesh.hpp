// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of a strut between the mitres at its ends. Private.

#include <array>
#include <vector>

#include "beam_graph_mesh.hpp"

namespace meso::brep {

/// A strut with its seam along x, and where all of it is in sight, along its axis.
struct MitredStrut {
  Vec3 origin, x, y, axis;
  double radius = 0, growth = 0;
  double begin = 0, end = 0;
};

/// `borders`: the points of both ends from the seam on, about the axis. They stay as they are, so neighbours agree.
/// Outward triangles. Thread rule: pure.
[[nodiscard]] Triangulation mitred_mesh(const MitredStrut& strut, const std::array<std::vector<Vec3>, 2>& borders);

}  // namespace meso::brep
