// SPDX-License-Identifier: Apache-2.0
#pragma once
// Takes apart what passes through itself in a mesh that is near its surface: where walls end at thin angles, tips of
// two sheets are closer to each other than the mesh is to either.
//
// Points are moved, edges collapsed or turned, one at a time and only where fewer triangles meet by that. What changes
// stays within the tolerance, and so do the places of points that moved, from the mesh. It stays a closed manifold.

#include <span>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/implicit/grid.hpp"
#include "surface_feet.hpp"

namespace meso::implicit {

/// Marks of points: those of triangles that were changed, and those of triangles that still meet others.
struct Untangled {
  std::vector<char> changed, stuck;
  std::size_t left = 0;  ///< of the latter, triangles
};

/// Points that are marked in `kept` stay as they are. What takes long is given up, as part of the mesh's size.
/// Coordinates are looked at as floats, as most files have them.
Untangled untangle_mesh(TriangleMesh& mesh, const Box3& box, SurfaceFeet& feet, double tolerance,
                        std::span<const char> kept, const RunOptions& run);

}  // namespace meso::implicit
