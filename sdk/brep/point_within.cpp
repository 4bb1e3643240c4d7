// SPDX-License-Identifier: Apache-2.0
#include "point_within.hpp"

#include <BOPTools_AlgoTools3D.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <IntTools_Context.hxx>
#include <algorithm>
#include <optional>

#include "face_moments.hpp"

namespace meso::brep {
namespace {

constexpr double deepest = 0.1, shallowest = 1e-4;  ///< of the face's extent

std::optional<Vec3> inward_normal(const TopoDS_Face& face, const gp_Pnt2d& at) {
  const BRepAdaptor_Surface surface(face, false);
  gp_Pnt point;
  gp_Vec along_u, along_v;
  surface.D1(at.X(), at.Y(), point, along_u, along_v);
  const gp_Vec normal = along_u.Crossed(along_v);
  if (normal.Magnitude() < 1e-12) return {};
  const double side = face.Orientation() == TopAbs_REVERSED ? 1 : -1;
  return side * to_vec(normal.Normalized().XYZ());
}

}  // namespace

std::vector<Vec3> points_within(const TopoDS_Shape& solid, std::size_t count) {
  std::vector<Vec3> points;
  const Handle(IntTools_Context) context = new IntTools_Context;
  BRepClass3d_SolidClassifier classifier(solid);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  const auto all = static_cast<std::size_t>(faces.Extent());
  for (std::size_t i = 0, taken = std::min(count, all); i < taken; ++i) {
    const TopoDS_Face& face = TopoDS::Face(faces(static_cast<int>(i * all / taken) + 1));
    gp_Pnt on_face;
    gp_Pnt2d at;
    if (BOPTools_AlgoTools3D::PointInFace(face, on_face, at, context) != 0) continue;
    const std::optional<Vec3> inwards = inward_normal(face, at);
    if (!inwards) continue;
    const Box3 box = face_box(face);
    for (double depth = deepest; depth >= shallowest; depth /= 10) {
      const Vec3 p = to_vec(on_face) + depth * norm(box.max - box.min) * *inwards;
      classifier.Perform(to_pnt(p), Precision::Confusion());
      if (classifier.State() != TopAbs_IN) continue;
      points.push_back(p);
      break;
    }
  }
  return points;
}

std::vector<Vec3> points_along_edges(const TopoDS_Shape& shape, std::size_t each) {
  std::vector<Vec3> points;
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  for (int e = 1; e <= edges.Extent(); ++e) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges(e));
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    const double first = curve.FirstParameter(), length = curve.LastParameter() - first;
    for (std::size_t k = 1; k <= each; ++k)
      points.push_back(to_vec(curve.Value(first + length * static_cast<double>(k) / static_cast<double>(each + 1))));
  }
  return points;
}

std::vector<Vec3> points_on_faces(const TopoDS_Shape& shape, std::size_t each) {
  std::vector<Vec3> points;
  const auto middle = [&](double low, double high, std::size_t k) {
    return low + (high - low) * (static_cast<double>(k) + 0.5) / static_cast<double>(each);
  };
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    const BRepAdaptor_Surface surface(face, false);
    BRepTopAdaptor_FClass2d classifier(face, Precision::PConfusion());
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    for (std::size_t i = 0; i < each; ++i)
      for (std::size_t j = 0; j < each; ++j) {
        const gp_Pnt2d at(middle(u0, u1, i), middle(v0, v1, j));
        if (classifier.Perform(at) == TopAbs_IN) points.push_back(to_vec(surface.Value(at.X(), at.Y())));
      }
  }
  return points;
}

}  // namespace meso::brep
