// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of a face on any surface, between the points of its edges in the plane of its parameters. Private.
//
// Where a face is narrower than the chords of its edges are off, as at the tips of a crescent, the chord of one edge
// passes points of another: then points are needed beside those, whatever the fineness. Dividing all edges alike
// does not help where two edges touch at the tip.

#include <set>

#include "lattice/template_mesh.hpp"

namespace meso::brep {

/// The parameters along `edge` (forward) of points on it, in order and rising, between those of its ends. Where the
/// edge is not quite the one that the points are from, and two feet on it are in the wrong order, by lengths.
[[nodiscard]] std::vector<double> parameters_on(const TopoDS_Edge& edge, const std::vector<Vec3>& inner);

/// A point that an edge of the template needs between two of its own.
struct NeededPoint {
  std::uint32_t edge = 0;
  std::size_t segment = 0;  ///< of its polygon, counted from vertex 0
  double at = 0;            ///< along the segment, 0 to 1
  Vec3 point;
};

struct ParameterMesh {
  Triangulation mesh;
  double fold = 0;                  ///< as in UnrolledMesh
  std::vector<NeededPoint> needed;  ///< that it may be without a fold
};

/// Empty if the edges of the face do not make closed loops, or have too many points.
[[nodiscard]] std::optional<ParameterMesh> parameter_mesh(const TopoDS_Face& face, const TemplateEdges& kind,
                                                          const Template& geometry, const EdgePolygons& polygons);

/// Of points that are close together one is taken. The edges that have new points.
std::set<std::uint32_t> insert(std::vector<NeededPoint> needed, EdgePolygons& polygons);

}  // namespace meso::brep
