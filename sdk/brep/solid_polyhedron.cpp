// SPDX-License-Identifier: Apache-2.0
// Plane faces between straight lines, put together by their corners' numbers: nothing is searched for.
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <algorithm>
#include <map>

#include "meso/base/number.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

using Faces = std::vector<std::size_t>;

/// A mirrored body is seen from the other side.
Polyhedron mapped(const Polyhedron& polyhedron, const Affine& map) {
  Polyhedron result = polyhedron;
  for (Vec3& v : result.vertices) v = map * v;
  if (determinant(map.linear) < 0)
    for (auto& face : result.faces) std::reverse(face.begin(), face.end());
  return result;
}

class Builder {
 public:
  explicit Builder(const Polyhedron& polyhedron) : p_(polyhedron), tolerances_(tolerances()) {
    for (std::size_t i = 0; i < p_.vertices.size(); ++i) {
      TopoDS_Vertex vertex;
      builder_.MakeVertex(vertex, to_pnt(p_.vertices[i]), tolerances_[i]);
      vertices_.push_back(vertex);
    }
  }

  [[nodiscard]] TopoDS_Shell shell(const Faces& faces) {
    TopoDS_Shell result;
    builder_.MakeShell(result);
    for (const std::size_t f : faces) builder_.Add(result, face(f));
    result.Closed(true);
    return result;
  }
  [[nodiscard]] TopoDS_Solid solid() {
    TopoDS_Solid result;
    builder_.MakeSolid(result);
    return result;
  }
  void add(TopoDS_Shape& to, const TopoDS_Shape& part) { builder_.Add(to, part); }

 private:
  /// How far corners stand off their faces' planes.
  [[nodiscard]] std::vector<double> tolerances() const {
    std::vector<double> result(p_.vertices.size(), Precision::Confusion());
    for (std::size_t f = 0; f < p_.faces.size(); ++f) {
      const FacePlane plane = plane_of(p_, f);
      for (const std::size_t v : p_.faces[f])
        result[v] = std::max(result[v], 1.01 * std::fabs(dot(plane.normal, p_.vertices[v]) - plane.offset));
    }
    return result;
  }
  [[nodiscard]] TopoDS_Edge edge(std::size_t from, std::size_t to) {
    const auto key = std::minmax(from, to);
    TopoDS_Edge& known = edges_[key];
    if (known.IsNull()) {
      known = BRepBuilderAPI_MakeEdge(vertices_[key.first], vertices_[key.second]).Edge();
      const double tolerance = std::max(tolerances_[key.first], tolerances_[key.second]);
      builder_.UpdateEdge(known, tolerance);
      for (const std::size_t v : {from, to}) builder_.UpdateVertex(vertices_[v], tolerance);
    }
    return TopoDS::Edge(known.Oriented(from < to ? TopAbs_FORWARD : TopAbs_REVERSED));
  }
  [[nodiscard]] TopoDS_Face face(std::size_t f) {
    const auto& corners = p_.faces[f];
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (std::size_t i = 0; i < corners.size(); ++i)
      builder_.Add(wire, edge(corners[i], corners[(i + 1) % corners.size()]));
    wire.Closed(true);
    const FacePlane plane = plane_of(p_, f);
    const Vec3 corner = p_.vertices[corners.front()];
    const Vec3 origin = corner - (dot(plane.normal, corner) - plane.offset) * plane.normal;
    return BRepBuilderAPI_MakeFace(gp_Pln(to_pnt(origin), to_dir(plane.normal)), wire, false).Face();
  }

  const Polyhedron& p_;
  BRep_Builder builder_;
  std::vector<double> tolerances_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::pair<std::size_t, std::size_t>, TopoDS_Edge> edges_;
};

struct Shell {
  Faces faces;
  double volume = 0;
};

std::vector<Shell> shells(const Polyhedron& p) {
  std::vector<Shell> result;
  const std::vector<std::size_t> numbers = shells_of(p);
  for (std::size_t f = 0; f < numbers.size(); ++f) {
    if (numbers[f] == result.size()) result.emplace_back();
    result[numbers[f]].faces.push_back(f);
  }
  for (Shell& shell : result) shell.volume = volume_of(p, shell.faces);
  return result;
}

/// The outer shell whose wall a cavity is seen from: the smallest that goes round it.
std::size_t around(const Polyhedron& p, const std::vector<Shell>& all, const Shell& cavity) {
  const Vec3 corner = p.vertices[p.faces[cavity.faces.front()].front()];
  std::size_t best = all.size();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].volume > 0 && winding_of(p, all[i].faces, corner) > 0.5 &&
        (best == all.size() || all[i].volume < all[best].volume))
      best = i;
  return best;
}

}  // namespace

std::optional<Solids> polyhedron_solids(const eval::PolyhedronShape& shape, const Affine& map, ElementId where,
                                        const SolidContext& context) {
  const Polyhedron p = mapped(shape.body, map);
  for (const auto& face : p.faces)
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 a = p.vertices[face[i]], b = p.vertices[face[(i + 1) % face.size()]];
      if (norm(b - a) > smallest_size && norm(a) < largest_size) continue;
      context.report(Code::geometry_size, where, {"an edge", format_number(norm(b - a))});
      return {};
    }
  Builder builder(p);
  const std::vector<Shell> all = shells(p);
  std::vector<TopoDS_Shape> solids(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].volume <= 0) continue;
    solids[i] = builder.solid();
    builder.add(solids[i], builder.shell(all[i].faces));
  }
  for (const Shell& shell : all)
    if (shell.volume <= 0) builder.add(solids[around(p, all, shell)], builder.shell(shell.faces));
  std::erase_if(solids, [](const TopoDS_Shape& solid) { return solid.IsNull(); });
  return solids;
}

}  // namespace meso::brep
