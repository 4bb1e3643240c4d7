// SPDX-License-Identifier: Apache-2.0
#include "lattice/template_mesh.hpp"

#include <BRepMesh_Context.hxx>
#include <BRepMesh_Deflection.hxx>
#include <BRepMesh_EdgeDiscret.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <IMeshData_Edge.hxx>
#include <IMeshData_Model.hxx>
#include <IMeshTools_CurveTessellator.hxx>
#include <tuple>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

/// Points and parameters of one edge along its own curve, as BRepMesh asks for them: counted from 1, ends included.
class GivenPoints : public IMeshTools_CurveTessellator {
 public:
  /// `inner` are the points between the ends, none for a degenerate edge.
  GivenPoints(const TopoDS_Edge& edge, const std::vector<Vec3>& inner) {
    double first = 0, last = 0;
    BRep_Tool::Range(edge, first, last);
    points_.emplace_back(first, BRep_Tool::Pnt(TopExp::FirstVertex(edge)));
    points_.emplace_back(last, BRep_Tool::Pnt(TopExp::LastVertex(edge)));
    for (const Vec3 p : inner) {
      const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), BRep_Tool::Curve(edge, first, last), first, last);
      if (foot.NbPoints() == 0) throw Standard_Failure("equal edges are not equal");
      points_.emplace_back(foot.LowerDistanceParameter(), to_pnt(p));
    }
    std::sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
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
    if (BRep_Tool::Degenerated(edge)) return new GivenPoints(edge, {});
    const OrbitMatcher::Match& match = kind_.matches.at(static_cast<std::size_t>(kind_.edges.FindIndex(edge) - 1));
    std::vector<Vec3> points = polygons_[match.edge];
    for (Vec3& p : points) p += cell_origin(geometry_, match.offset);
    return new GivenPoints(edge, points);
  }

  const TemplateEdges& kind_;
  const Template& geometry_;
  const EdgePolygons& polygons_;
};

std::vector<Vec3> divide(const TopoDS_Edge& edge, const MeshFineness& fineness) {
  const BRepAdaptor_Curve curve(edge);
  const bool straight = curve.GetType() == GeomAbs_Line;
  const bool closed = TopExp::FirstVertex(edge).IsSame(TopExp::LastVertex(edge));
  // A closed edge of fewer than four segments would fold its faces flat.
  const GCPnts_TangentialDeflection points(curve, fineness.angle, fineness.deflection, straight ? 2 : closed ? 5 : 3);
  std::vector<Vec3> inner;
  for (int i = 2; i < points.NbPoints(); ++i) inner.push_back(to_vec(points.Value(i)));
  return inner;
}

}  // namespace

EdgePolygons mesh_alike(const std::vector<TemplateEdges>& kinds, const Template& geometry,
                        const MeshFineness& fineness) {
  EdgePolygons polygons(geometry.edges.size());
  std::vector<bool> divided(geometry.edges.size());
  for (const TemplateEdges& kind : kinds)
    for (std::size_t i = 0; i < kind.matches.size(); ++i) {
      const std::uint32_t orbit = kind.matches[i].edge;  // first met: that edge is the template's own
      if (divided[orbit] || geometry.edges[orbit].degenerate) continue;
      divided[orbit] = true;
      polygons[orbit] = divide(TopoDS::Edge(kind.edges(static_cast<int>(i) + 1)), fineness);
    }
  IMeshTools_Parameters parameters;
  parameters.Deflection = fineness.deflection;
  parameters.Angle = fineness.angle;
  parameters.InParallel = Standard_True;
  for (const TemplateEdges& kind : kinds) {
    const Handle(BRepMesh_Context) context = new BRepMesh_Context;
    context->SetEdgeDiscret(new GivenEdges(kind, geometry, polygons));
    BRepMesh_IncrementalMesh mesher;
    mesher.SetShape(kind.shell);
    mesher.ChangeParameters() = parameters;
    mesher.Perform(context);
  }
  return polygons;
}

bool share_points(FaceTemplate& face, const Template& geometry, const EdgePolygons& polygons, double tolerance) {
  struct Shared {
    Vec3 at;
    MeshPoint name;
    bool met = false;
  };
  std::vector<Shared> shared;
  const auto add = [&](Vec3 point, const Index3& offset) {
    shared.push_back({.at = point + cell_origin(geometry, offset), .name = {point, offset}});
  };
  for (const auto& loop : face.loops)
    for (const Coedge& use : loop) {
      const EdgeTemplate& edge = geometry.edges[use.edge];
      for (const std::size_t k : {0, 1}) add(geometry.vertices[edge.vertex[k]], use.offset + edge.vertex_offset[k]);
      for (const Vec3 p : polygons[use.edge]) add(p, use.offset);
    }
  for (MeshPoint& p : face.mesh.points) {
    const Vec3 at = p.point;
    for (Shared& s : shared) {
      if (norm(s.at - at) > tolerance) continue;
      p = s.name;
      s.met = true;
    }
  }
  return std::all_of(shared.begin(), shared.end(), [](const Shared& s) { return s.met; });
}

}  // namespace meso::brep
