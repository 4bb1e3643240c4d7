// SPDX-License-Identifier: Apache-2.0
#include "lattice/orbit_matcher.hpp"

#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <optional>

#include "geometry_values.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

constexpr int sample_count = 32;

Index3 minus(const Index3& a, const Index3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

std::vector<Vec3> points_along(const TopoDS_Edge& edge) {
  const BRepAdaptor_Curve curve(edge);
  std::vector<Vec3> points;
  for (int i = 0; i < sample_count; ++i) {
    const double t = (i + 0.5) / sample_count;
    points.push_back(to_vec(curve.Value((1 - t) * curve.FirstParameter() + t * curve.LastParameter())));
  }
  return points;
}

/// Points closer than `size` are in one small box or in two that touch.
std::array<std::int64_t, 3> small_box(Vec3 p, double size) {
  std::array<std::int64_t, 3> box{};
  for (std::size_t i = 0; i < 3; ++i) box[i] = static_cast<std::int64_t>(std::floor(p[i] / size));
  return box;
}
std::uint64_t hash_of(const std::array<std::int64_t, 3>& box) {
  std::uint64_t hash = 0;
  for (const std::int64_t i : box) hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15u;
  return hash;
}

/// Whether `p` is on the edge, and whether its direction there agrees with `along`.
struct OnEdge {
  bool on = false, same_direction = false;
};
OnEdge on_edge(const TopoDS_Edge& edge, Vec3 p, Vec3 along, double tolerance) {
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), curve, first, last);
  if (foot.NbPoints() == 0 || foot.LowerDistance() > tolerance) return {};
  gp_Pnt at;
  gp_Vec tangent;
  curve->D1(foot.LowerDistanceParameter(), at, tangent);
  return {.on = true, .same_direction = dot(to_vec(tangent.XYZ()), along) > 0};
}

}  // namespace

void OrbitMatcher::begin_solid() {
  of_solid_.Clear();
  matches_.clear();
  corners_.clear();
}

OrbitMatcher::VertexMatch OrbitMatcher::match_vertex(const TopoDS_Vertex& vertex) {
  const auto index = static_cast<std::size_t>(of_solid_.Add(vertex)) - 1;
  if (index == matches_.size()) matches_.push_back(find_or_add(to_vec(BRep_Tool::Pnt(vertex))));
  return matches_[index];
}

OrbitMatcher::VertexMatch OrbitMatcher::find_or_add(Vec3 p) {
  VertexMatch found;
  for (std::size_t i = 0; i < 3; ++i) {
    const double size = geometry_.lattice(i, i);
    found.offset[i] = static_cast<std::int32_t>(std::floor((p[i] - origin_[i] + tolerance_) / size));
  }
  const Vec3 home = p - cell_origin(geometry_, found.offset);
  const std::array<std::int64_t, 3> at = small_box(home, tolerance_);
  std::optional<std::uint32_t> known;
  double least = tolerance_;
  const auto is_another = [&](std::uint32_t v) {
    const auto corner = corners_.find({v, found.offset});
    return corner != corners_.end() && norm(corner->second - p) > tolerance_ / 100;
  };
  for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x)
    for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
      for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
        const auto near = vertices_.find(hash_of({x, y, z}));
        if (near == vertices_.end()) continue;
        for (const std::uint32_t v : near->second)
          if (const double away = norm(geometry_.vertices[v] - home); away <= least && !is_another(v)) {
            known = v;
            least = away;
          }
      }
  if (known) {
    found.vertex = *known;
  } else {
    found.vertex = static_cast<std::uint32_t>(geometry_.vertices.size());
    geometry_.vertices.push_back(home);
    vertices_[hash_of(at)].push_back(found.vertex);
  }
  corners_.emplace(std::pair(found.vertex, found.offset), p);
  return found;
}

OrbitMatcher::Match OrbitMatcher::match(const TopoDS_Edge& oriented) {
  const TopoDS_Edge edge = TopoDS::Edge(oriented.Oriented(TopAbs_FORWARD));
  const VertexMatch start = match_vertex(TopExp::FirstVertex(edge));
  const VertexMatch end = match_vertex(TopExp::LastVertex(edge));
  const std::vector<Vec3> points = points_along(edge);
  const Vec3 middle = points[sample_count / 2];
  const Vec3 along = points[sample_count / 2 + 1] - points[sample_count / 2 - 1];
  auto& candidates = edges_[std::minmax(start.vertex, end.vertex)];
  for (const std::uint32_t candidate : candidates) {
    const EdgeTemplate& other = geometry_.edges[candidate];
    for (const bool flipped : {false, true}) {
      const std::size_t k = flipped ? 1 : 0;
      if (other.vertex[k] != start.vertex || other.vertex[1 - k] != end.vertex) continue;
      const Index3 offset = minus(start.offset, other.vertex_offset[k]);
      if (minus(end.offset, other.vertex_offset[1 - k]) != offset) continue;
      const Vec3 shift = cell_origin(geometry_, offset);
      const OnEdge hit = on_edge(shapes_[candidate], middle - shift, along, 4 * tolerance_);
      if (!hit.on || hit.same_direction == flipped) continue;
      const auto lies_on = [&](Vec3 p) { return on_edge(shapes_[candidate], p - shift, along, 4 * tolerance_).on; };
      if (lies_on(points[sample_count / 5]) && lies_on(points[sample_count * 4 / 5]))
        return {candidate, offset, flipped};
    }
  }
  const auto fresh = static_cast<std::uint32_t>(geometry_.edges.size());
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  geometry_.edges.push_back({.curve = to_curve(curve, first, last),
                             .vertex = {start.vertex, end.vertex},
                             .vertex_offset = {start.offset, end.offset},
                             .degenerate = false});
  samples_.push_back(points);
  shapes_.push_back(edge);
  candidates.push_back(fresh);
  return {fresh, {}, false};
}

OrbitMatcher::Match OrbitMatcher::add_degenerate(const TopoDS_Edge& edge) {
  const VertexMatch pole = match_vertex(TopExp::FirstVertex(edge));
  const auto fresh = static_cast<std::uint32_t>(geometry_.edges.size());
  geometry_.edges.push_back({.curve = Line{},
                             .vertex = {pole.vertex, pole.vertex},
                             .vertex_offset = {pole.offset, pole.offset},
                             .degenerate = true});
  samples_.emplace_back();
  shapes_.push_back(edge);
  return {fresh, {}, false};
}

}  // namespace meso::brep
