// SPDX-License-Identifier: Apache-2.0
#include "lattice/orbit_matcher.hpp"

#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <algorithm>

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

/// How far `p` is from the edge, and whether its direction there agrees with `along`.
struct OnEdge {
  double distance = HUGE_VAL;
  bool same_direction = false;
};
OnEdge on_edge(const TopoDS_Edge& edge, Vec3 p, Vec3 along) {
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), curve, first, last);
  if (foot.NbPoints() == 0) return {};
  gp_Pnt at;
  gp_Vec tangent;
  curve->D1(foot.LowerDistanceParameter(), at, tangent);
  return {.distance = foot.LowerDistance(), .same_direction = dot(to_vec(tangent.XYZ()), along) > 0};
}

}  // namespace

OrbitMatcher::Home OrbitMatcher::home_of(Vec3 p) const {
  Home out;
  for (std::size_t i = 0; i < 3; ++i) {
    const double size = geometry_.lattice(i, i);
    out.offset[i] = static_cast<std::int32_t>(std::floor((p[i] - origin_[i] + tolerance_) / size));
  }
  out.place = p - cell_origin(geometry_, out.offset);
  return out;
}

void OrbitMatcher::add_candidates(Vec3 p, std::size_t own, std::vector<Possible<VertexMatch>>& to) const {
  const Home home = home_of(p);
  const std::array<std::int64_t, 3> at = small_box(home.place, tolerance_);
  for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x)
    for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
      for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
        const auto near = vertices_.find(hash_of({x, y, z}));
        if (near == vertices_.end()) continue;
        for (const std::uint32_t v : near->second)
          if (const double away = norm(geometry_.vertices[v] - home.place); away <= tolerance_)
            to.push_back({away, own, {v, home.offset}});
      }
}

void OrbitMatcher::take_closest(std::vector<Possible<VertexMatch>> candidates) {
  std::ranges::stable_sort(candidates, {}, &Possible<VertexMatch>::distance);
  for (const auto& [distance, own, match] : candidates) {
    if (matches_[own]) continue;
    const Vec3 p = to_vec(BRep_Tool::Pnt(TopoDS::Vertex(of_solid_(static_cast<int>(own) + 1))));
    const auto [corner, fresh] = corners_.emplace(std::pair(match.vertex, match.offset), p);
    if (fresh || norm(corner->second - p) <= tolerance_ / 100) matches_[own] = match;
  }
}

OrbitMatcher::VertexMatch OrbitMatcher::add(Vec3 p) {
  const Home home = home_of(p);
  const auto fresh = static_cast<std::uint32_t>(geometry_.vertices.size());
  geometry_.vertices.push_back(home.place);
  vertices_[hash_of(small_box(home.place, tolerance_))].push_back(fresh);
  corners_.emplace(std::pair(fresh, home.offset), p);
  return {fresh, home.offset};
}

void OrbitMatcher::match_vertices(const TopTools_IndexedMapOfShape& edges) {
  of_solid_.Clear();
  corners_.clear();
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge edge = TopoDS::Edge(edges(i).Oriented(TopAbs_FORWARD));
    of_solid_.Add(TopExp::FirstVertex(edge));
    of_solid_.Add(TopExp::LastVertex(edge));
  }
  matches_.assign(static_cast<std::size_t>(of_solid_.Extent()), {});
  const auto place = [&](std::size_t v) {
    return to_vec(BRep_Tool::Pnt(TopoDS::Vertex(of_solid_(static_cast<int>(v) + 1))));
  };
  std::vector<Possible<VertexMatch>> candidates;
  for (std::size_t v = 0; v < matches_.size(); ++v) add_candidates(place(v), v, candidates);
  take_closest(std::move(candidates));
  for (std::size_t v = 0; v < matches_.size(); ++v) {
    if (matches_[v]) continue;
    std::vector<Possible<VertexMatch>> images;  // of others of the solid, on opposite sides
    add_candidates(place(v), v, images);
    take_closest(std::move(images));
    if (!matches_[v]) matches_[v] = add(place(v));
  }
}

void OrbitMatcher::add_candidates(const std::vector<Own>& edges, std::size_t own, std::vector<Candidate>& to) const {
  const auto& [edge, start, end, points, match] = edges[own];
  const auto known = edges_.find(std::minmax(start.vertex, end.vertex));
  if (known == edges_.end()) return;
  const Vec3 along = points[sample_count / 2 + 1] - points[sample_count / 2 - 1];
  for (const std::uint32_t candidate : known->second) {
    const EdgeTemplate& other = geometry_.edges[candidate];
    for (const bool flipped : {false, true}) {
      const std::size_t k = flipped ? 1 : 0;
      if (other.vertex[k] != start.vertex || other.vertex[1 - k] != end.vertex) continue;
      const Index3 offset = minus(start.offset, other.vertex_offset[k]);
      if (minus(end.offset, other.vertex_offset[1 - k]) != offset) continue;
      const Vec3 shift = cell_origin(geometry_, offset);
      double distance = 0;
      for (const int i : {sample_count / 2, sample_count / 5, sample_count * 4 / 5}) {
        const OnEdge at = on_edge(shapes_[candidate], points[static_cast<std::size_t>(i)] - shift, along);
        distance = std::fmax(distance, at.distance);
        if (i == sample_count / 2 && at.same_direction == flipped) distance = HUGE_VAL;
        if (distance > 4 * tolerance_) break;
      }
      if (distance <= 4 * tolerance_) to.push_back({distance, own, {candidate, offset, flipped}});
    }
  }
}

void OrbitMatcher::take_closest(std::vector<Candidate> candidates, std::vector<Own>& edges) {
  std::ranges::stable_sort(candidates, {}, &Candidate::distance);
  for (const Candidate& candidate : candidates)
    if (auto& match = edges[candidate.own].match;
        !match && taken_.emplace(candidate.match.edge, candidate.match.offset).second)
      match = candidate.match;
}

std::vector<OrbitMatcher::Match> OrbitMatcher::match(const TopTools_IndexedMapOfShape& edges) {
  match_vertices(edges);
  taken_.clear();
  std::vector<Own> own;
  std::vector<Candidate> candidates;
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge edge = TopoDS::Edge(edges(i).Oriented(TopAbs_FORWARD));
    Own& value = own.emplace_back(Own{edge, match_of(TopExp::FirstVertex(edge)), {}, {}, {}});
    if (BRep_Tool::Degenerated(edge)) continue;
    value.end = match_of(TopExp::LastVertex(edge));
    value.points = points_along(edge);
    add_candidates(own, own.size() - 1, candidates);
  }
  take_closest(std::move(candidates), own);
  std::vector<Match> out;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!own[i].match && own[i].points.empty()) own[i].match = add_degenerate(own[i].start, own[i].edge);
    if (!own[i].match) {  // perhaps the image of another one on the opposite side
      std::vector<Candidate> images;
      add_candidates(own, i, images);
      take_closest(std::move(images), own);
    }
    if (!own[i].match) own[i].match = add(own[i]);
    out.push_back(*own[i].match);
  }
  return out;
}

OrbitMatcher::Match OrbitMatcher::add(const Own& own) {
  const auto fresh = static_cast<std::uint32_t>(geometry_.edges.size());
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(own.edge, first, last);
  geometry_.edges.push_back({.curve = to_curve(curve, first, last),
                             .vertex = {own.start.vertex, own.end.vertex},
                             .vertex_offset = {own.start.offset, own.end.offset},
                             .degenerate = false});
  samples_.push_back(own.points);
  shapes_.push_back(own.edge);
  edges_[std::minmax(own.start.vertex, own.end.vertex)].push_back(fresh);
  taken_.emplace(fresh, Index3{});
  return {fresh, {}, false};
}

OrbitMatcher::Match OrbitMatcher::add_degenerate(const VertexMatch& pole, const TopoDS_Edge& edge) {
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
