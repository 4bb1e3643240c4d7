// SPDX-License-Identifier: Apache-2.0
#pragma once
// The border of a face on a sphere as a STEP file has it. OpenCASCADE's reader takes the wrong side of some loops that
// run along a seam or meet themselves in a point; without these it reads the same face.

#include <tuple>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::step {

/// A vertex, and its cell.
using VertexKey = std::tuple<std::uint32_t, brep::Index3>;

/// Where a use of an edge begins (0) or ends (1), in the cell of the face.
[[nodiscard]] VertexKey vertex_of(const brep::Coedge& use, std::size_t end, const brep::Template& geometry);

using Loops = std::vector<std::vector<brep::Coedge>>;

/// Loops that pass no vertex twice and have no seams (edges that `face` has on both sides) and poles in them. None
/// where a loop is all seam, as on a whole sphere: that is what the reader expects, and loops are best as they are.
[[nodiscard]] Loops plain_loops(const brep::FaceTemplate& face, const brep::Template& geometry);

/// Whether loops touch: a vertex is passed twice.
[[nodiscard]] bool touch(const Loops& loops, const brep::Template& geometry);

}  // namespace meso::step
