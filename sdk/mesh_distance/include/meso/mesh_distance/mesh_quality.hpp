// SPDX-License-Identifier: Apache-2.0
#pragma once
// What was found in a surface mesh while it was made ready for distances.

#include <cstdint>

namespace meso::implicit {

struct MeshQuality {
  std::uint64_t triangles = 0;   ///< used
  std::uint64_t degenerate = 0;  ///< of them, without area: they count as edges and points
  std::uint64_t cancelled = 0;   ///< dropped: the same triangle twice, with opposite sides out
  std::uint64_t repeated = 0;    ///< dropped: the same triangle again
  std::uint64_t turned = 0;      ///< turned over to agree with the triangles around them
  // Of what is left. All 0 in a closed mesh; they are not looked for there.
  std::uint64_t open_edges = 0;      ///< of one triangle
  std::uint64_t flipped_edges = 0;   ///< of two triangles that disagree
  std::uint64_t multiple_edges = 0;  ///< of more than two, not balanced
  // Of a closed mesh.
  std::uint64_t looked_at = 0;  ///< triangles spread over the mesh
  std::uint64_t buried = 0;     ///< of them, inside on both sides: walls that the distance sees
  bool closed = false;          ///< every edge is used as often in one direction as in the other: inside is exact
  bool inside_out = false;      ///< the enclosed volume is negative; the body is used turned right
};

}  // namespace meso::implicit
