// SPDX-License-Identifier: Apache-2.0
#include "face_mesh.hpp"

#include <Poly_PolygonOnTriangulation.hxx>

namespace meso::brep {

Triangulation FaceMesher::mesh_of(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) throw Standard_Failure("a face could not be meshed");
  Triangulation result;
  for (int i = 1; i <= mesh->NbNodes(); ++i)
    result.points.push_back({.point = to_vec(mesh->Node(i).Transformed(location.Transformation()))});
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
    take_edge_points(face, TopoDS::Edge(it.Current()), result.points);

  const bool flip = (face.Orientation() == TopAbs_REVERSED) != location.Transformation().IsNegative();
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (flip) std::swap(b, c);
    const std::array<std::uint32_t, 3> t{static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1),
                                         static_cast<std::uint32_t>(c - 1)};
    const Vec3 &p = result.points[t[0]].point, &q = result.points[t[1]].point, &r = result.points[t[2]].point;
    if (p != q && q != r && r != p) result.triangles.push_back(t);
  }
  return result;
}

void FaceMesher::take_edge_points(const TopoDS_Face& face, const TopoDS_Edge& edge, std::vector<MeshPoint>& points) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
  if (polygon.IsNull()) throw Standard_Failure("an edge could not be meshed");
  const int count = polygon->NbNodes();
  const auto node = [&](int k) -> MeshPoint& { return points[static_cast<std::size_t>(polygon->Node(k) - 1)]; };
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  const Vec3 first = vertex_points_[static_cast<std::size_t>(vertices_.FindIndex(TopExp::FirstVertex(forward)) - 1)];
  const Vec3 last = vertex_points_[static_cast<std::size_t>(vertices_.FindIndex(TopExp::LastVertex(forward)) - 1)];

  std::vector<Vec3>& shared = edge_points_[static_cast<std::size_t>(edges_.FindIndex(edge))];
  if (shared.empty()) {
    const bool degenerate = BRep_Tool::Degenerated(edge);
    for (int k = 1; k <= count; ++k) shared.push_back(degenerate ? first : node(k).point);
    shared.front() = first;
    shared.back() = last;
  }
  if (static_cast<int>(shared.size()) != count) throw Standard_Failure("faces disagree on the mesh of their edge");
  for (int k = 1; k <= count; ++k) node(k).point = shared[static_cast<std::size_t>(k - 1)];
}

}  // namespace meso::brep
