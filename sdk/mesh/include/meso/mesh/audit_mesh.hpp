// SPDX-License-Identifier: Apache-2.0
#pragma once
// Is a triangle mesh watertight, and what does it enclose?
//
//   const MeshAudit a = audit_mesh(mesh);
//   if (!a.watertight()) ...
//
// Topology is that of the indices: equal points must be one point (see Weld). Self-intersections are not looked for.
// Cost: one sort of three half-edges a triangle, 0.4 s and 48 bytes a triangle for a million. Thread rule: pure.

#include <cstdint>

#include "meso/base/triangle_mesh.hpp"

namespace meso {

struct MeshAudit {
  std::uint64_t triangles = 0, points = 0;
  std::uint64_t unmatched_half_edges = 0;  ///< no triangle on the other side: a hole
  std::uint64_t flipped_edges = 0;         ///< two triangles, both in the same direction: normals disagree
  std::uint64_t multiple_edges = 0;        ///< more than two triangles: not a manifold
  std::uint64_t degenerate = 0;            ///< triangles with a corner twice, or of no area
  std::uint64_t components = 0;            ///< sets of triangles connected by points
  double volume = 0;                       ///< enclosed; negative if inside out; meaningless with holes
  double area = 0;
  Box3 box;

  [[nodiscard]] bool watertight() const {
    return triangles > 0 && unmatched_half_edges + flipped_edges + multiple_edges == 0;
  }
};

[[nodiscard]] MeshAudit audit_mesh(const TriangleMesh& mesh);

}  // namespace meso
