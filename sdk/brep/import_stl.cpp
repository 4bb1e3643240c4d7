// SPDX-License-Identifier: Apache-2.0
#include "import_stl.hpp"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <map>
#include <numeric>

#include "boolean.hpp"
#include "meso/import_surface_mesh/read_stl.hpp"

namespace meso::brep {
namespace {

/// Faces and edges of a mesh as topology: facets share edges because their corners have equal indices, so no sewing
/// tolerance is needed.
class Facets {
 public:
  explicit Facets(const TriangleMesh& mesh) : mesh_(mesh) {
    vertices_.reserve(mesh.points.size());
    for (const Vec3 p : mesh.points) vertices_.push_back(BRepBuilderAPI_MakeVertex(to_pnt(p)));
  }

  /// Null if the triangle has no area.
  [[nodiscard]] TopoDS_Face face(const std::array<std::uint32_t, 3>& t) {
    const Vec3 a = mesh_.points[t[0]], b = mesh_.points[t[1]], c = mesh_.points[t[2]];
    const Vec3 normal = cross(b - a, c - a);
    if (!(norm(normal) > 0)) return {};
    BRepBuilderAPI_MakeWire wire;
    for (std::size_t i = 0; i < 3; ++i) wire.Add(edge(t[i], t[(i + 1) % 3]));
    return BRepBuilderAPI_MakeFace(gp_Pln(to_pnt(a), to_dir(normal / norm(normal))), wire.Wire(), true).Face();
  }

 private:
  TopoDS_Edge edge(std::uint32_t from, std::uint32_t to) {
    const auto key = std::minmax(from, to);
    auto& known = edges_[{key.first, key.second}];
    if (known.IsNull()) known = BRepBuilderAPI_MakeEdge(vertices_[key.first], vertices_[key.second]).Edge();
    return from < to ? known : TopoDS::Edge(known.Reversed());
  }

  const TriangleMesh& mesh_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, TopoDS_Edge> edges_;
};

/// For every triangle, the number of its connected surface: triangles that share a corner.
std::vector<std::size_t> surfaces_of(const TriangleMesh& mesh, std::size_t& count) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 1; i < 3; ++i) parent[root(t[i])] = root(t[0]);
  std::map<std::uint32_t, std::size_t> numbers;
  std::vector<std::size_t> surfaces;
  surfaces.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    surfaces.push_back(numbers.try_emplace(root(t[0]), numbers.size()).first->second);
  count = numbers.size();
  return surfaces;
}

TopoDS_Solid solid_of(const TopoDS_Shell& shell) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  return solid;
}

}  // namespace

std::optional<Solids> read_stl_solids(const Resource& file, ElementId where, const SolidContext& context) {
  const std::string name = file.name().string();
  std::string error;
  const auto bytes = ResourceBytes::open(file, error);
  if (!bytes) {
    context.report(Code::import_unreadable, where, {name, "it cannot be opened"});
    return {};
  }
  const auto mesh = read_stl(bytes->view(), name, context.sink);
  if (!mesh) return {};
  std::size_t count = 0;
  const std::vector<std::size_t> surfaces = surfaces_of(*mesh, count);
  const BRep_Builder builder;
  std::vector<TopoDS_Shell> shells(count);
  for (TopoDS_Shell& shell : shells) builder.MakeShell(shell);
  Facets facets(*mesh);
  for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
    const TopoDS_Face face = facets.face(mesh->triangles[i]);
    if (face.IsNull()) {
      context.report(Code::import_not_closed, where,
                     {name, "triangle " + std::to_string(i + 1) + " has no area"});
      return {};
    }
    builder.Add(shells[surfaces[i]], face);
  }
  Solids solids;
  for (TopoDS_Shell& shell : shells) {
    shell.Closed(true);
    solids.push_back(solid_of(shell));
  }
  return solids;
}

}  // namespace meso::brep
