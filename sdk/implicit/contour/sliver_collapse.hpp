// SPDX-License-Identifier: Apache-2.0
#pragma once
// Removes the slivers that marching cubes leaves around nodes the surface passes close by.
//
// Edges shorter than a quarter of the spacing are collapsed, shortest first, onto one of their ends: no point moves off
// the surface. An edge stays where collapsing it would join other edges (its ends must have exactly two neighbours in
// common, so a closed edge-manifold stays one), fold or thin a triangle, take a point off the planes of the box, or
// where the other end is more than a fiftieth of the spacing away from a plane around the end that goes.
//
// About 2 us a triangle; 32 bytes a triangle and 20 a point beside the mesh. Thread rule: pure.

#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

/// `spacing` is the smallest of the grid. False if stopped by `run`: the mesh is then unfinished.
[[nodiscard]] bool collapse_slivers(TriangleMesh& mesh, const Box3& box, double spacing, const RunOptions& run);

}  // namespace meso::implicit
