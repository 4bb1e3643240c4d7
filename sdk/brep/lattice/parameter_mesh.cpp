// SPDX-License-Identifier: Apache-2.0
#include "lattice/parameter_mesh.hpp"

#include <algorithm>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

EdgePoints named_points(const TopoDS_Edge& edge, const TemplateEdges& kind, const Template& geometry,
                        const EdgePolygons& polygons) {
  const OrbitMatcher::Match& match = kind.match_of(edge);
  const EdgeTemplate& orbit = geometry.edges[match.edge];
  const auto end = [&](std::size_t k) {
    return MeshPoint{geometry.vertices[orbit.vertex[k]], match.offset + orbit.vertex_offset[k]};
  };
  EdgePoints out;
  double first = 0, last = 0;
  BRep_Tool::Range(edge, first, last);
  if (orbit.degenerate) return {.points = {end(0), end(0)}, .parameters = {first, last}};
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  out.parameters = parameters_on(forward, points_of(match, geometry, polygons));
  out.parameters.insert(out.parameters.begin(), first);
  out.parameters.push_back(last);
  out.points = {end(0)};
  for (const Vec3 p : polygons[match.edge]) out.points.push_back({p, match.offset});
  out.points.push_back(end(1));
  if (match.flipped) std::ranges::reverse(out.points);
  return out;
}

}  // namespace

std::optional<BorderedMesh> parameter_mesh(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
                                           const EdgePolygons& polygons) {
  return bordered_mesh(face, geometry,
                       [&](const TopoDS_Edge& edge) { return named_points(edge, kind, geometry, polygons); });
}

PolygonPoint of_orbit(const NeededPoint& p, const TemplateEdges& kind, const Template& geometry,
                      const EdgePolygons& polygons) {
  const OrbitMatcher::Match& match = kind.match_of(p.edge);
  return {.edge = match.edge,
          .segment = match.flipped ? polygons[match.edge].size() - p.segment : p.segment,
          .at = match.flipped ? 1 - p.at : p.at,
          .point = p.point - cell_origin(geometry, match.offset)};
}

std::set<std::uint32_t> insert(std::vector<PolygonPoint> needed, EdgePolygons& polygons) {
  std::set<std::uint32_t> out;
  for (const PolygonPoint& p : apart_from_last(std::move(needed))) {
    std::vector<Vec3>& polygon = polygons[p.edge];
    polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(p.segment), p.point);
    out.insert(p.edge);
  }
  return out;
}

}  // namespace meso::brep
