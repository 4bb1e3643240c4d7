// SPDX-License-Identifier: Apache-2.0
#include "lattice/imprint.hpp"

#include <BOPAlgo_Builder.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>

namespace meso::brep {
namespace {

bool contains(const std::vector<Vec3>& points, Vec3 p, double tolerance) {
  return std::any_of(points.begin(), points.end(), [&](Vec3 q) { return norm(p - q) < tolerance; });
}

std::vector<Vec3> vertices_of(const TopoDS_Shape& solid, double tolerance) {
  std::vector<Vec3> points;
  for (TopExp_Explorer it(solid, TopAbs_VERTEX); it.More(); it.Next()) {
    const Vec3 p = to_vec(BRep_Tool::Pnt(TopoDS::Vertex(it.Current())));
    if (!contains(points, p, tolerance)) points.push_back(p);
  }
  return points;
}

/// Where a point of the box's surface is seen again, itself included: on the opposite walls.
std::vector<Vec3> images(Vec3 p, const CellShape& cell) {
  std::vector<Vec3> found{p};
  bool on_wall = false;
  for (std::size_t i = 0; i < 3; ++i)
    for (const int side : {0, 1}) {
      if (std::fabs(p[i] - (side ? cell.box.max : cell.box.min)[i]) > cell.tolerance()) continue;
      on_wall = true;
      const std::size_t count = found.size();
      for (std::size_t k = 0; k < count; ++k) {
        Vec3 q = found[k];
        q[i] += side ? -cell.size()[i] : cell.size()[i];
        found.push_back(q);
      }
    }
  return on_wall ? found : std::vector<Vec3>{};
}

bool on_some_edge(const TopoDS_Shape& solid, Vec3 p, double tolerance) {
  const TopoDS_Vertex vertex = BRepBuilderAPI_MakeVertex(to_pnt(p));
  for (TopExp_Explorer it(solid, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepExtrema_DistShapeShape distance(vertex, edge);
    if (distance.IsDone() && distance.Value() < tolerance) return true;
  }
  return false;
}

}  // namespace

TopoDS_Shape divided_at(const TopoDS_Shape& solid, const std::vector<Vec3>& points) {
  BOPAlgo_Builder builder;
  for (TopExp_Explorer it(solid, TopAbs_SOLID); it.More(); it.Next()) builder.AddArgument(it.Current());
  for (const Vec3 p : points) builder.AddArgument(BRepBuilderAPI_MakeVertex(to_pnt(p)).Vertex());
  builder.SetNonDestructive(true);
  builder.Perform();
  if (builder.HasErrors()) return {};
  TopoDS_Compound result;
  BRep_Builder().MakeCompound(result);
  for (TopExp_Explorer it(builder.Shape(), TopAbs_SOLID); it.More(); it.Next())
    BRep_Builder().Add(result, it.Current());
  return result;
}

bool divide_alike(std::vector<TopoDS_Shape>& solids, const CellShape& cell) {
  const double tolerance = 4 * cell.tolerance();
  // A division of one solid may ask for one of another; two rounds settle it, because no new point is ever made.
  for (int round = 0; round < 2; ++round) {
    std::vector<Vec3> wanted;
    for (const TopoDS_Shape& solid : solids)
      for (const Vec3 p : vertices_of(solid, tolerance))
        for (const Vec3 q : images(p, cell))
          if (!contains(wanted, q, tolerance)) wanted.push_back(q);
    for (TopoDS_Shape& solid : solids) {
      const std::vector<Vec3> own = vertices_of(solid, tolerance);
      std::vector<Vec3> missing;
      for (const Vec3 q : wanted)
        if (!contains(own, q, tolerance) && on_some_edge(solid, q, tolerance)) missing.push_back(q);
      if (missing.empty()) continue;
      solid = divided_at(solid, missing);
      if (solid.IsNull()) return false;
    }
  }
  return true;
}

}  // namespace meso::brep
