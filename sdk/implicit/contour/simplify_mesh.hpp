// SPDX-License-Identifier: Apache-2.0
#pragma once
// Fewer triangles, by collapsing edges in the order of what that costs (Garland and Heckbert 1997).
//
// A vertex remembers the planes of all triangles it stands for, as a quadric; an edge is collapsed where the mean
// square of the distances to them is least, and while its root is at most half of `bound`. An edge stays where
// collapsing it would join other edges (its ends must have exactly two neighbours in common, so a closed manifold stays
// one), would turn a triangle by more than 60 degrees, or would take a point off the planes of the box. The bound is
// one of planes: whether the mesh is as close to the surface has to be measured.
//
// About 5 us and 400 bytes a triangle. Thread rule: pure.

#include <span>

#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

/// Points marked in `kept` stay, if any are. False if stopped by `run`: the mesh is then unfinished.
[[nodiscard]] bool simplify_mesh(TriangleMesh& mesh, const Box3& box, double bound, const RunOptions& run,
                                 std::span<const char> kept = {});

}  // namespace meso::implicit
