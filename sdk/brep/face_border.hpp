// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of a face on any surface, between the points of its edges in the plane of its parameters. Private.
//
// Where a face is narrower than the chords of its edges are off, as at the tips of a crescent, the chord of one edge
// passes points of another: then points are needed beside those, whatever the fineness. Dividing all edges alike
// does not help where two edges touch at the tip.

#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "meso/brep/body.hpp"
#include "meso/brep/placement.hpp"
#include "occt.hpp"

namespace meso::brep {

/// Two mesh points with one name are one.
using PointName = std::pair<std::array<double, 3>, Index3>;
[[nodiscard]] inline PointName name_of(const MeshPoint& p) { return {{p.point.x, p.point.y, p.point.z}, p.offset}; }

/// Along an edge (forward), ends included. Edges that meet have the same point for their vertex, and a degenerate one
/// has it twice.
struct EdgePoints {
  std::vector<MeshPoint> points;
  std::vector<double> parameters;
};

/// Whether an edge of a face is part of its border; a line in which the face is touched is none.
[[nodiscard]] bool bounds(const TopoDS_Edge& edge);

/// Where a point of a mesh is in the template's coordinates.
[[nodiscard]] inline Vec3 place_of(const MeshPoint& p, const Template& geometry) {
  return p.point + cell_origin(geometry, p.offset);
}

/// In millimetres; less shows nowhere, and edges that are known to no more may cross.
[[nodiscard]] double negligible_fold(const TopoDS_Face& face, double deflection);

/// Whether the triangles that OpenCASCADE has made of a face are folded by more: as they are, not as the parameters are
/// that they were made in. `places` of its points; of further ones, halves on the border, the folds are those of the
/// whole. `triangles` look outward.
[[nodiscard]] bool is_folded(const TopoDS_Face& face, const std::vector<Vec3>& places,
                             const std::vector<std::array<std::uint32_t, 3>>& triangles, double deflection);

/// The parameters along `edge` (forward) of points on it, in order and rising, between those of its ends. Where the
/// edge is not quite the one that the points are from, and two feet on it are in the wrong order, by lengths.
[[nodiscard]] std::vector<double> parameters_on(const TopoDS_Edge& edge, const std::vector<Vec3>& inner);

/// A point that an edge needs between two that it has.
struct NeededPoint {
  TopoDS_Edge edge;
  std::size_t segment = 0;  ///< between its points, counted along the edge
  double at = 0;            ///< along the segment, 0 to 1
  double parameter = 0;     ///< along the edge
  Vec3 point;
};

/// The same, where edges have numbers.
struct PolygonPoint {
  std::uint32_t edge = 0;
  std::size_t segment = 0;
  double at = 0;
  double parameter = 0;
  Vec3 point;
};
/// Of points that are close together one is taken; the last of each edge come first, so that those that are yet to be
/// inserted keep their segments.
[[nodiscard]] std::vector<PolygonPoint> apart_from_last(std::vector<PolygonPoint> points);

struct BorderedMesh {
  Triangulation mesh;
  double fold = 0;                  ///< as in UnrolledMesh
  std::vector<NeededPoint> needed;  ///< that it may be without a fold
};

/// Empty if the edges of the face do not make closed loops, or have too many points. Throws Standard_Failure.
[[nodiscard]] std::optional<BorderedMesh> bordered_mesh(const TopoDS_Face& face, const Template& geometry,
                                                        const std::function<EdgePoints(const TopoDS_Edge&)>& points_of);

}  // namespace meso::brep
