// SPDX-License-Identifier: Apache-2.0
#include "face_border.hpp"

#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "unrolled_mesh.hpp"

namespace meso::brep {
namespace {

/// The points of an edge in the direction of a loop, but its last, which begins the next edge.
struct Stretch {
  TopoDS_Edge edge;
  std::vector<MeshPoint> points;
  std::vector<PlanePoint> at;
  std::vector<double> parameters;  ///< along the edge, of the last point, too
  PointName start, end;
  PlanePoint end_at{};
};

Stretch stretch_of(const TopoDS_Edge& edge, const TopoDS_Face& face, const EdgePoints& given) {
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) throw Standard_Failure("an edge has no curve on its face");
  Stretch out{.edge = edge, .points = given.points, .parameters = given.parameters};
  for (const double t : out.parameters) {
    const gp_Pnt2d p = curve->Value(t);
    out.at.push_back({p.X(), p.Y()});
  }
  if (edge.Orientation() == TopAbs_REVERSED) {
    std::ranges::reverse(out.points);
    std::ranges::reverse(out.at);
    std::ranges::reverse(out.parameters);
  }
  out.start = name_of(out.points.front());
  out.end = name_of(out.points.back());
  out.end_at = out.at.back();
  out.points.pop_back();
  out.at.pop_back();
  return out;
}

double between(const PlanePoint& a, const PlanePoint& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

/// Of those that begin where `last` ends the one that does so on the surface, too: seams are gone along twice.
std::vector<Stretch>::iterator next_after(const Stretch& last, std::vector<Stretch>& stretches) {
  auto nearest = stretches.end();
  double least = HUGE_VAL;
  for (auto it = stretches.begin(); it != stretches.end(); ++it) {
    const double away = between(it->at.front(), last.end_at);
    if (it->start == last.end && away < least) std::tie(least, nearest) = std::tuple(away, it);
  }
  return nearest;
}

using Loop = std::vector<Stretch>;

/// Empty if the edges do not make closed loops.
std::vector<Loop> chained(std::vector<Stretch> stretches) {
  std::vector<Loop> loops;
  while (!stretches.empty()) {
    Loop& loop = loops.emplace_back();
    auto next = stretches.begin();
    do {
      if (next == stretches.end()) return {};
      loop.push_back(std::move(*next));
      stretches.erase(next);
      next = next_after(loop.back(), stretches);
      const PlanePoint& end = loop.back().end_at;
      if (loop.front().start != loop.back().end) continue;
      if (next == stretches.end() || between(loop.front().at.front(), end) <= between(next->at.front(), end)) break;
    } while (true);
  }
  return loops;
}

/// The border of a face as it is told to `unrolled_mesh`, and where its points are from.
class FaceBorder {
 public:
  FaceBorder(const TopoDS_Face& face, std::vector<Loop> loops, const Template& geometry)
      : face_(face), loops_(std::move(loops)), geometry_(geometry) {
    for (const Loop& loop : loops_) {
      for (const Stretch& stretch : loop)
        for (const MeshPoint& p : stretch.points) places_.push_back(place_of(p, geometry));
      ends_.push_back(places_.size());
    }
  }

  [[nodiscard]] std::optional<BorderedMesh> mesh() const {
    std::vector<BorderLoop> borders;
    BorderedMesh out;
    for (const Loop& loop : loops_) {
      BorderLoop& border = borders.emplace_back();
      const auto begin = static_cast<std::ptrdiff_t>(out.mesh.points.size());
      for (const Stretch& stretch : loop)
        for (std::size_t i = 0; i < stretch.points.size(); ++i) {
          out.mesh.points.push_back(stretch.points[i]);
          border.push_back({place_of(stretch.points[i], geometry_), stretch.at[i]});
        }
      if (!is_reversed()) continue;
      std::reverse(out.mesh.points.begin() + begin, out.mesh.points.end());
      std::ranges::reverse(border);
    }
    auto unrolled = unrolled_mesh(BRep_Tool::Surface(face_), borders);
    if (!unrolled) return {};
    out.fold = unrolled->fold;
    for (auto& t : unrolled->triangles) {
      if (is_reversed()) std::swap(t[1], t[2]);
      bool is_flat = false;  // at a pole
      for (std::size_t k = 0; k < 3; ++k)
        is_flat = is_flat || name_of(out.mesh.points[t[k]]) == name_of(out.mesh.points[t[(k + 1) % 3]]);
      if (!is_flat) out.mesh.triangles.push_back(t);
    }
    if (out.fold > 0) out.needed = needed();
    return out;
  }

 private:
  [[nodiscard]] bool is_reversed() const { return face_.Orientation() == TopAbs_REVERSED; }

  /// Beside each point of the border that lies between an edge and its chord.
  [[nodiscard]] std::vector<NeededPoint> needed() const {
    std::vector<NeededPoint> out;
    std::size_t at = 0, loop = 0, begin = 0;
    for (const Loop& stretches : loops_) {
      for (const Stretch& stretch : stretches) {
        for (std::size_t i = 0; i < stretch.points.size(); ++i) {
          const std::size_t next = at + 1 == ends_[loop] ? begin : at + 1;
          if (!BRep_Tool::Degenerated(stretch.edge)) add_needed(stretch, i, places_[at], places_[next], out);
          ++at;
        }
      }
      begin = ends_[loop++];
    }
    return out;
  }

  void add_needed(const Stretch& stretch, std::size_t i, Vec3 a, Vec3 b, std::vector<NeededPoint>& out) const {
    constexpr double beside_end = 1e-3;  // of the chord
    const Vec3 along = b - a;
    const double length = norm(along);
    if (length == 0) return;
    const Vec3 normal = outward(stretch.at[i]);
    if (norm(normal) == 0) return;  // at a pole
    const Vec3 left = cross(normal, along) / length;
    const auto [first, last] = std::minmax(stretch.parameters[i], stretch.parameters[i + 1]);
    double unused_first = 0, unused_last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(stretch.edge, unused_first, unused_last);
    for (const Vec3 p : places_) {
      const double s = dot(p - a, along) / (length * length), side = dot(p - a, left);
      if (s < beside_end || s > 1 - beside_end || side >= 0 || -side > length) continue;
      const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), curve, first, last);
      if (foot.NbPoints() == 0) continue;
      const Vec3 q = to_vec(foot.NearestPoint());
      if (dot(q - a, left) > side + 1e-9 * length) continue;  // beyond the edge, too: on another side of the face
      const bool along_edge = stretch.edge.Orientation() != TopAbs_REVERSED;
      const double at = dot(q - a, along) / (length * length);
      if (at < beside_end || at > 1 - beside_end) continue;
      out.push_back({.edge = stretch.edge,
                     .segment = along_edge ? i : stretch.points.size() - 1 - i,
                     .at = along_edge ? at : 1 - at,
                     .parameter = foot.LowerDistanceParameter(),
                     .point = q});
    }
  }

  /// The face's normal; 0 where it has none.
  [[nodiscard]] Vec3 outward(const PlanePoint& at) const {
    gp_Pnt p;
    gp_Vec u, v;
    BRep_Tool::Surface(face_)->D1(at[0], at[1], p, u, v);
    const Vec3 normal = to_vec(u.Crossed(v).XYZ());
    return norm(normal) > 0 ? (is_reversed() ? -1 : 1) / norm(normal) * normal : Vec3{};
  }

  const TopoDS_Face& face_;
  std::vector<Loop> loops_;
  const Template& geometry_;
  std::vector<Vec3> places_;       ///< of all points
  std::vector<std::size_t> ends_;  ///< of the loops
};

}  // namespace

bool bounds(const TopoDS_Edge& edge) {
  return edge.Orientation() == TopAbs_FORWARD || edge.Orientation() == TopAbs_REVERSED;
}

double negligible_fold(const TopoDS_Face& face, double deflection) {
  double out = 1e-3 * deflection;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
    out = std::fmax(out, 2 * BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  return out;
}

bool is_folded(const TopoDS_Face& face, const std::vector<Vec3>& places,
               const std::vector<std::array<std::uint32_t, 3>>& triangles, double deflection) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) own = BRep_Tool::Triangulation(face, location);
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (GeomAdaptor_Surface(surface).GetType() == GeomAbs_Plane || !own->HasUVNodes()) return false;
  std::vector<BorderPoint> points;
  for (int i = 1; i <= own->NbNodes(); ++i) {
    const gp_Pnt2d at = own->UVNode(i);
    points.push_back({places[static_cast<std::size_t>(i) - 1], {at.X(), at.Y()}});
  }
  std::vector<std::array<std::uint32_t, 3>> of_own;
  for (auto t : triangles) {
    if (face.Orientation() == TopAbs_REVERSED) std::swap(t[1], t[2]);
    if (std::ranges::all_of(t, [&](std::uint32_t p) { return p < points.size(); })) of_own.push_back(t);
  }
  return fold_of(surface, points, of_own) > negligible_fold(face, deflection);
}

std::vector<double> parameters_on(const TopoDS_Edge& edge, const std::vector<Vec3>& inner) {
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  std::vector<double> out;
  double before = first;
  for (const Vec3 p : inner) {
    const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), curve, first, last);
    if (foot.NbPoints() == 0 || foot.LowerDistanceParameter() <= before) break;
    out.push_back(before = foot.LowerDistanceParameter());
  }
  if (out.size() == inner.size() && before < last) return out;
  std::vector<double> lengths;
  double length = 0;
  Vec3 end = to_vec(curve->Value(first));
  for (const Vec3 p : inner) {
    lengths.push_back(length += norm(p - end));
    end = p;
  }
  length += norm(to_vec(curve->Value(last)) - end);
  out.clear();
  for (const double until : lengths) out.push_back(first + until / length * (last - first));
  return out;
}

std::vector<PolygonPoint> apart_from_last(std::vector<PolygonPoint> points) {
  constexpr double apart = 0.02;  // of a segment
  std::ranges::sort(points, std::greater{}, [](const PolygonPoint& p) { return std::tuple(p.edge, p.segment, p.at); });
  std::vector<PolygonPoint> out;
  for (const PolygonPoint& p : points) {
    const bool is_close =
        !out.empty() && p.edge == out.back().edge && p.segment == out.back().segment && p.at > out.back().at - apart;
    if (!is_close) out.push_back(p);
  }
  return out;
}

std::optional<BorderedMesh> bordered_mesh(const TopoDS_Face& face, const Template& geometry,
                                          const std::function<EdgePoints(const TopoDS_Edge&)>& points_of) {
  std::vector<Stretch> stretches;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    if (bounds(edge)) stretches.push_back(stretch_of(edge, face, points_of(edge)));
  }
  auto loops = chained(std::move(stretches));
  if (loops.empty()) return {};
  return FaceBorder(face, std::move(loops), geometry).mesh();
}

}  // namespace meso::brep
