// SPDX-License-Identifier: Apache-2.0
#pragma once
// How far apart the pieces of a body's boundary are. Faces, edges and vertices are stored each on its own; that an edge
// lies on its two faces, and triangles near their face, is a promise, measured here from the geometry itself.
//
//   const Gaps g = measure_gaps(body);      // g.edge_mm: what OpenCASCADE would call the largest edge tolerance
//
// Each template face is looked at once, however often it stands in the body: 7 points of each triangle, 9 of each edge.
// What cannot be measured is NaN. Cost: about 0.2 us a point, 20 us on B-spline surfaces. Thread rule: pure.

#include "meso/brep/body.hpp"

namespace meso::brep {

struct Gaps {
  double edge_mm = 0;            ///< largest distance of an edge from a surface that it bounds
  double vertex_mm = 0;          ///< largest distance of a vertex from the end of an edge
  double triangle_mm = 0;        ///< largest distance of a triangle from its surface
  double triangles_mm3 = 0;      ///< volume between the triangles and the faces, outwards positive
  double triangles_abs_mm3 = 0;  ///< the same where nothing cancels
};

[[nodiscard]] Gaps measure_gaps(const Body& body);

/// What the triangles of a meshed body enclose; those of a round strut less than the strut. 20 ns a face.
[[nodiscard]] double volume_of_triangles(const Body& body);

}  // namespace meso::brep
