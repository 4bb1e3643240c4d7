// SPDX-License-Identifier: Apache-2.0
#include "lattice/template_mesh.hpp"

#include <BRepMesh_Context.hxx>
#include <BRepMesh_Deflection.hxx>
#include <BRepMesh_EdgeDiscret.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <IMeshData_Edge.hxx>
#include <IMeshData_Model.hxx>
#include <IMeshTools_CurveTessellator.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "lattice/border_mesh.hpp"
#include "lattice/parameter_mesh.hpp"
#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"
#include "stop_watch.hpp"
#include "unrolled_mesh.hpp"

namespace meso::brep {
namespace {

/// Points and parameters of one edge along its own curve, as BRepMesh asks for them: counted from 1, ends included.
class GivenPoints : public IMeshTools_CurveTessellator {
 public:
  /// `inner` are the points between the ends in the order of the curve, none for a degenerate edge.
  GivenPoints(const TopoDS_Edge& edge, const std::vector<Vec3>& inner) {
    double first = 0, last = 0;
    BRep_Tool::Range(edge, first, last);
    points_.emplace_back(first, BRep_Tool::Pnt(TopExp::FirstVertex(edge)));
    const std::vector<double> parameters = parameters_on(edge, inner);
    for (std::size_t i = 0; i < inner.size(); ++i) points_.emplace_back(parameters[i], to_pnt(inner[i]));
    points_.emplace_back(last, BRep_Tool::Pnt(TopExp::LastVertex(edge)));
  }
  Standard_Integer PointsNb() const override { return static_cast<Standard_Integer>(points_.size()); }
  Standard_Boolean Value(Standard_Integer index, gp_Pnt& point, Standard_Real& parameter) const override {
    std::tie(parameter, point) = points_.at(static_cast<std::size_t>(index - 1));
    return Standard_True;
  }

 private:
  std::vector<std::pair<double, gp_Pnt>> points_;
};

/// BRepMesh divides each edge by what its faces need; here the division is given.
class GivenEdges : public IMeshTools_ModelAlgo {
 public:
  GivenEdges(const TemplateEdges& kind, const Template& geometry, const EdgePolygons& polygons)
      : kind_(kind), geometry_(geometry), polygons_(polygons) {}

 protected:
  Standard_Boolean performInternal(const Handle(IMeshData_Model) & model, const IMeshTools_Parameters& parameters,
                                   const Message_ProgressRange&) override {
    for (Standard_Integer i = 0; i < model->EdgesNb(); ++i) {
      const IMeshData::IEdgeHandle& edge = model->GetEdge(i);
      BRepMesh_Deflection::ComputeDeflection(edge, model->GetMaxSize(), parameters);
      BRepMesh_EdgeDiscret::Tessellate3d(edge, tessellator(edge->GetEdge()), Standard_True);
      BRepMesh_EdgeDiscret::Tessellate2d(edge, Standard_True);
    }
    return Standard_True;
  }

 private:
  [[nodiscard]] Handle(IMeshTools_CurveTessellator) tessellator(const TopoDS_Edge& edge) const {
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Degenerated(edge)) return new GivenPoints(forward, {});
    return new GivenPoints(forward, points_of(kind_.match_of(edge), geometry_, polygons_));
  }

  const TemplateEdges& kind_;
  const Template& geometry_;
  const EdgePolygons& polygons_;
};

/// `times`: how often the edge has been found too coarse.
std::vector<Vec3> divide(const TopoDS_Edge& edge, const MeshFineness& fineness, int times) {
  const BRepAdaptor_Curve curve(edge);
  const bool straight = curve.GetType() == GeomAbs_Line;
  const bool closed = TopExp::FirstVertex(edge).IsSame(TopExp::LastVertex(edge));
  // A closed edge of fewer than four segments would fold its faces flat.
  const int segments = (straight ? 1 : closed ? 4 : 2) << times;
  const GCPnts_TangentialDeflection points(curve, std::ldexp(fineness.angle, -times),
                                           std::ldexp(fineness.deflection, -2 * times), segments + 1);
  std::vector<Vec3> inner;
  for (int i = 2; i < points.NbPoints(); ++i) inner.push_back(to_vec(points.Value(i)));
  return inner;
}

void mesh_one(const TemplateEdges& kind, const Template& geometry, const EdgePolygons& polygons,
              const MeshFineness& fineness, const RunOptions& run) {
  const Handle(StopWatch) watch = new StopWatch(run);
  const Handle(BRepMesh_Context) context = new BRepMesh_Context;
  context->SetEdgeDiscret(new GivenEdges(kind, geometry, polygons));
  BRepMesh_IncrementalMesh mesher;
  mesher.SetShape(kind.shell);
  mesher.ChangeParameters().Deflection = fineness.deflection;
  mesher.ChangeParameters().Angle = fineness.angle;
  mesher.ChangeParameters().InParallel = run.jobs != 1;
  BRepTools::Clean(kind.shell);
  mesher.Perform(context, watch->Start());
}

/// OpenCASCADE puts more points on an edge where the parameters of a face run close, as they do at the pole of a ball.
/// They are taken over for all faces; false if there are none.
bool take_points(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry, EdgePolygons& polygons,
                 std::vector<bool>& taken) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) return false;
  bool any = false;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
    const OrbitMatcher::Match& match = kind.match_of(edge);
    if (polygon.IsNull() || geometry.edges[match.edge].degenerate) continue;
    std::vector<Vec3>& known = polygons[match.edge];
    if (polygon->NbNodes() <= static_cast<int>(known.size()) + 2) continue;
    known.clear();
    for (int k = 2; k < polygon->NbNodes(); ++k)
      known.push_back(to_vec(mesh->Node(polygon->Node(k)).Transformed(location.Transformation())) -
                      cell_origin(geometry, match.offset));
    if (match.flipped) std::ranges::reverse(known);
    taken[match.edge] = any = true;
  }
  return any;
}

/// Segments that have been gone along once more in one direction than in the other.
class Segments {
 public:
  void add(const MeshPoint& from, const MeshPoint& to, int times) {
    const PointName a = name_of(from), b = name_of(to);
    if (a == b) return;
    (a < b ? counts_[{a, b}] : counts_[{b, a}]) += a < b ? times : -times;
  }
  [[nodiscard]] bool cancel() const {
    return std::ranges::all_of(counts_, [](const auto& segment) { return segment.second == 0; });
  }

 private:
  std::map<std::pair<PointName, PointName>, int> counts_;
};

/// OpenCASCADE's triangles, if they reach the edges and are not folded.
std::optional<Triangulation> own_mesh(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
                                      const EdgePolygons& polygons, const MeshFineness& fineness) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) return {};
  Triangulation out;
  for (int i = 1; i <= mesh->NbNodes(); ++i)
    out.points.push_back({.point = to_vec(mesh->Node(i).Transformed(location.Transformation()))});
  std::vector<std::pair<std::vector<std::uint32_t>, bool>> borders;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
    if (polygon.IsNull()) return {};
    const OrbitMatcher::Match& match = kind.match_of(edge);
    const EdgeTemplate& orbit = geometry.edges[match.edge];
    const auto& [nodes, reversed] =
        borders.emplace_back(std::vector<std::uint32_t>{}, edge.Orientation() == TopAbs_REVERSED);
    for (int k = 1; k <= polygon->NbNodes(); ++k) {
      if (polygon->Node(k) < 1) return {};  // the mesher has left the point out
      borders.back().first.push_back(static_cast<std::uint32_t>(polygon->Node(k) - 1));
    }
    const auto end = [&](std::size_t k) {
      return MeshPoint{geometry.vertices[orbit.vertex[k]], match.offset + orbit.vertex_offset[k]};
    };
    if (orbit.degenerate) {
      for (const std::uint32_t node : nodes) out.points[node] = end(0);
      continue;
    }
    const std::vector<Vec3>& inner = polygons[match.edge];
    if (nodes.size() != inner.size() + 2) return {};
    out.points[nodes.front()] = end(match.flipped ? 1 : 0);
    out.points[nodes.back()] = end(match.flipped ? 0 : 1);
    for (std::size_t k = 0; k < inner.size(); ++k)
      out.points[nodes[k + 1]] = {inner[match.flipped ? inner.size() - 1 - k : k], match.offset};
  }
  const bool flip = (face.Orientation() == TopAbs_REVERSED) != location.Transformation().IsNegative();
  Segments segments;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (flip) std::swap(b, c);
    const std::array<std::uint32_t, 3> t{static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1),
                                         static_cast<std::uint32_t>(c - 1)};
    bool folded = false;
    for (std::size_t k = 0; k < 3; ++k)
      folded = folded || name_of(out.points[t[k]]) == name_of(out.points[t[(k + 1) % 3]]);
    for (std::size_t k = 0; k < 3; ++k) segments.add(out.points[t[k]], out.points[t[(k + 1) % 3]], 1);
    if (!folded) out.triangles.push_back(t);
  }
  for (const auto& [nodes, reversed] : borders)
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
      segments.add(out.points[nodes[k]], out.points[nodes[k + 1]], reversed ? 1 : -1);
  std::vector<Vec3> places;
  for (const MeshPoint& p : out.points) places.push_back(place_of(p, geometry));
  if (!segments.cancel() || is_folded(face, places, out.triangles, fineness.deflection)) return {};
  return out;
}

/// What edges lack for the faces that could not be meshed yet.
struct Wanted {
  explicit Wanted(std::size_t edges) : taken(edges), coarse(edges) {}
  void insert_needed(EdgePolygons& polygons) {
    std::erase_if(needed, [&](const PolygonPoint& p) { return coarse[p.edge] || taken[p.edge]; });
    for (const std::uint32_t edge : insert(std::move(needed), polygons)) taken[edge] = true;
  }

  std::vector<PolygonPoint> needed;
  std::vector<bool> taken;   ///< have got points, and are to keep them
  std::vector<bool> coarse;  ///< to be divided further
};

/// False: it will be, with the points that are wanted. The last time, folds are put up with.
bool is_meshed(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
               const MeshFineness& fineness, bool is_last, EdgePolygons& polygons, Wanted& wanted) {
  if (own_mesh(face, kind, geometry, polygons, fineness)) return true;
  if (border_mesh(face, kind, geometry, polygons, fineness)) return true;
  const auto unrolled = parameter_mesh(face, kind, geometry, polygons);
  if (unrolled && is_last) return true;
  if (unrolled && !unrolled->needed.empty()) {
    for (const NeededPoint& p : unrolled->needed) wanted.needed.push_back(of_orbit(p, kind, geometry, polygons));
    return false;
  }
  if (take_points(face, kind, geometry, polygons, wanted.taken)) return false;
  if (unrolled && unrolled->fold <= negligible_fold(face, fineness.deflection)) return true;
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next())
    wanted.coarse[kind.match_of(TopoDS::Edge(edge.Current())).edge] = true;
  return false;
}

}  // namespace

std::vector<Vec3> points_of(const OrbitMatcher::Match& match, const Template& geometry, const EdgePolygons& polygons) {
  std::vector<Vec3> points = polygons[match.edge];
  for (Vec3& p : points) p += cell_origin(geometry, match.offset);
  if (match.flipped) std::ranges::reverse(points);
  return points;
}

EdgePolygons mesh_alike(const std::vector<TemplateEdges>& kinds, const Template& geometry, const MeshFineness& fineness,
                        const RunOptions& run) {
  constexpr int most_divisions = 5;
  EdgePolygons polygons(geometry.edges.size());
  std::vector<int> divisions(geometry.edges.size(), 0);
  std::vector<bool> changed(geometry.edges.size(), true), taken(geometry.edges.size(), false);  // as they are now
  for (int round = 0; round <= most_divisions; ++round) {
    const bool is_last = round == most_divisions;
    std::vector<bool> divided = taken;
    for (const TemplateEdges& kind : kinds)
      for (std::size_t i = 0; i < kind.matches.size(); ++i) {
        const std::uint32_t orbit = kind.matches[i].edge;
        if (divided[orbit] || !changed[orbit] || geometry.edges[orbit].degenerate) continue;
        divided[orbit] = true;
        polygons[orbit] = divide(TopoDS::Edge(kind.edges(static_cast<int>(i) + 1).Oriented(TopAbs_FORWARD)), fineness,
                                 divisions[orbit]);
      }
    Wanted wanted(geometry.edges.size());
    bool done = true;
    for (const TemplateEdges& kind : kinds) {
      if (run.should_stop()) throw Standard_Failure("stopped");
      const bool touched = std::ranges::any_of(kind.matches, [&](const auto& m) { return bool{changed[m.edge]}; });
      if (!touched) continue;
      mesh_one(kind, geometry, polygons, fineness, run);
      for (TopoDS_Iterator it(kind.shell); it.More(); it.Next()) {
        const TopoDS_Face& face = TopoDS::Face(it.Value());
        done = is_meshed(face, kind, geometry, fineness, is_last, polygons, wanted) && done;
      }
    }
    if (done) return polygons;
    wanted.insert_needed(polygons);
    for (std::size_t e = 0; e < taken.size(); ++e) {
      divisions[e] += wanted.coarse[e];
      taken[e] = wanted.taken[e] && !wanted.coarse[e];
      changed[e] = wanted.coarse[e] || taken[e];
    }
  }
  throw Standard_Failure("a face cannot be divided into triangles");
}

std::optional<Triangulation> named_mesh(const TopoDS_Face& face, const TemplateEdges& kind, const Template& geometry,
                                        const EdgePolygons& polygons, const MeshFineness& fineness) {
  if (auto mesh = own_mesh(face, kind, geometry, polygons, fineness)) return mesh;
  if (auto mesh = border_mesh(face, kind, geometry, polygons, fineness)) return mesh;
  auto unrolled = parameter_mesh(face, kind, geometry, polygons);
  return unrolled ? std::optional(std::move(unrolled->mesh)) : std::nullopt;
}

}  // namespace meso::brep
