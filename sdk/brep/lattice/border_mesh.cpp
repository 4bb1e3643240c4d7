// SPDX-License-Identifier: Apache-2.0
#include "lattice/border_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "beam_graph_mesh.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"
#include "plane_mesh.hpp"

namespace meso::brep {
namespace {

using Loops = std::vector<std::vector<MeshPoint>>;

/// The points of the edges in their order, with the face on the left. Empty if the edges do not tell it.
Loops loops_of(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
               const EdgePolygons& polygons) {
  std::map<PointName, std::vector<MeshPoint>> from;  // the points of an edge but its last, by its first
  std::map<PointName, PointName> next;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    const OrbitMatcher::Match& match = kind.match_of(edge);
    const EdgeTemplate& orbit = geometry.edges[match.edge];
    if (orbit.degenerate) return {};
    std::vector<MeshPoint> points;
    points.push_back({geometry.vertices[orbit.vertex[0]], match.offset + orbit.vertex_offset[0]});
    for (const Vec3 p : polygons[match.edge]) points.push_back({p, match.offset});
    points.push_back({geometry.vertices[orbit.vertex[1]], match.offset + orbit.vertex_offset[1]});
    if (match.flipped != (edge.Orientation() == TopAbs_REVERSED)) std::ranges::reverse(points);
    const PointName start = name_of(points.front()), end = name_of(points.back());
    points.pop_back();
    if (!from.emplace(start, std::move(points)).second) return {};
    next.emplace(start, end);
  }
  Loops loops;
  while (!from.empty()) {
    auto& loop = loops.emplace_back();
    const PointName first = from.begin()->first;
    PointName at = first;
    do {
      const auto points = from.find(at);
      if (points == from.end()) return {};
      loop.insert(loop.end(), points->second.begin(), points->second.end());
      from.erase(points);
      at = next.at(at);
    } while (at != first);
  }
  return loops;
}

/// Where the edges run in a plane, to a millionth of the cell, it is as good as the surface. A face narrower than ten
/// of those may be bent more, if much less than triangles may be off.
std::optional<Triangulation> flat_mesh(const std::vector<MeshPoint>& border, const Template& geometry,
                                       const MeshFineness& fineness) {
  Triangulation out{.points = border, .triangles = {}};
  std::vector<Vec3> places;
  Vec3 middle{}, normal{};
  for (const MeshPoint& p : out.points) middle += places.emplace_back(place_of(p, geometry));
  middle = middle / static_cast<double>(places.size());
  double around = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 next = places[(i + 1) % places.size()];
    normal += cross(places[i] - middle, next - middle);
    around += norm(next - places[i]);
  }
  if (norm(normal) == 0) return {};
  const double millionth = 1e-6 * std::cbrt(std::fabs(determinant(geometry.lattice))), width = norm(normal) / around;
  const double allowed = width < 10 * millionth ? std::fmax(millionth, fineness.deflection / 100) : millionth;
  normal = normal / norm(normal);
  const Vec3 x = (places[0] - middle) / norm(places[0] - middle), y = cross(normal, x);
  std::vector<PlanePoint> flat;
  std::vector<std::uint32_t> loop;
  for (const Vec3 p : places) {
    if (std::fabs(dot(p - middle, normal)) > allowed) return {};
    loop.push_back(static_cast<std::uint32_t>(flat.size()));
    flat.push_back({dot(p - middle, x), dot(p - middle, y)});
  }
  auto triangles = triangulate_between(flat, std::span(&loop, 1));
  if (!triangles) return {};
  out.triangles = std::move(*triangles);
  return out;
}

std::optional<Triangulation> ball_mesh(const SphereSurface& sphere, const Loops& loops, const Template& geometry,
                                       const MeshFineness& fineness) {
  std::vector<std::vector<Vec3>> places;
  std::map<std::array<double, 3>, MeshPoint> named;
  for (const auto& loop : loops) {
    auto& around = places.emplace_back();
    for (const MeshPoint& p : loop) {
      const Vec3 at = around.emplace_back(place_of(p, geometry));
      named.emplace(std::array{at.x, at.y, at.z}, p);
    }
  }
  auto mesh = sphere_mesh(sphere, places, fineness.deflection, fineness.angle, {});
  if (!mesh) return {};
  for (MeshPoint& p : mesh->points)
    if (const auto known = named.find({p.point.x, p.point.y, p.point.z}); known != named.end()) p = known->second;
  return mesh;
}

}  // namespace

std::optional<Triangulation> border_mesh(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
                                         const EdgePolygons& polygons, const MeshFineness& fineness) {
  const Loops loops = loops_of(face, kind, geometry, polygons);
  if (loops.empty()) return {};
  if (loops.size() == 1)
    if (auto mesh = flat_mesh(loops.front(), geometry, fineness)) return mesh;
  const BRepAdaptor_Surface surface(face, false);
  if (surface.GetType() != GeomAbs_Sphere || face.Orientation() == TopAbs_REVERSED) return {};
  const gp_Sphere sphere = surface.Sphere();
  return ball_mesh({{to_vec(sphere.Location())}, sphere.Radius()}, loops, geometry, fineness);
}

}  // namespace meso::brep
