// SPDX-License-Identifier: Apache-2.0
#include "lattice/whole_cell.hpp"

#include "boolean.hpp"
#include "face_moments.hpp"

namespace meso::brep {
namespace {

std::vector<Triangle3> triangles_of(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) throw Standard_Failure("a face of a cell could not be meshed");
  const auto node = [&](int i) { return to_vec(mesh->Node(i).Transformed(location.Transformation())); };
  std::vector<Triangle3> out;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    out.push_back({node(a), node(b), node(c)});
  }
  return out;
}

}  // namespace

double share_of(const FaceMoments& m) { return (m.volume_moment.x + m.volume_moment.y + m.volume_moment.z) / 3; }

std::vector<TopoDS_Face> faces_in(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) faces.push_back(TopoDS::Face(it.Current()));
  return faces;
}

void WholeCell::add(const TopoDS_Face& face, Role role) {
  const FaceMoments m = face_moments(face);
  Face& value = faces.emplace_back(Face{face, triangles_of(face), {}, share_of(m), m.vector_area, role});
  for (const Triangle3& triangle : value.triangles)
    for (const Vec3 p : triangle) value.box.extend(p);
  if (role == Role::solid_wall) return;
  volume += value.share;
  probe.add_group(value.triangles);
}

WholeCell whole_cell(const TopoDS_Shape& solid, double deflection) {
  WholeCell out;
  out.reach = 3 * deflection;
  const Solids parts = solids_of(BRepBuilderAPI_Copy(solid).Shape());
  for (const TopoDS_Shape& part : parts) {
    BRepMesh_IncrementalMesh(part, deflection, Standard_False, 0.3);
    for (const TopoDS_Face& face : faces_in(part)) out.add(face, WholeCell::Role::skin);
    out.solids.emplace_back(part);
  }
  return out;
}

}  // namespace meso::brep
