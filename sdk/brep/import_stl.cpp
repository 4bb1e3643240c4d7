// SPDX-License-Identifier: Apache-2.0
#include "import_stl.hpp"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <algorithm>
#include <map>
#include <numeric>

#include "boolean.hpp"
#include "box_pairs.hpp"
#include "facet_tree.hpp"
#include "meso/base/faces_cross.hpp"
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

/// Two triangles of one surface that cross each other, counted from 1, or nothing. Surfaces that overlap are united.
std::optional<std::pair<std::size_t, std::size_t>> crossing(const TriangleMesh& mesh,
                                                            const std::vector<std::size_t>& surfaces) {
  Polyhedron polyhedron{mesh.points, {}};
  std::vector<Box3> boxes;
  Box3 all;
  for (const auto& t : mesh.triangles) {
    polyhedron.faces.push_back({t[0], t[1], t[2]});
    Box3& box = boxes.emplace_back();
    for (const std::uint32_t point : t) box.extend(mesh.points[point]);
    all.extend(box.min);
    all.extend(box.max);
  }
  const double tolerance = 1e-9 * norm(all.max - all.min);
  std::optional<std::pair<std::size_t, std::size_t>> found;
  visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
    if (surfaces[i] != surfaces[k] || !faces_cross(polyhedron, i, k, tolerance)) return;
    const std::pair<std::size_t, std::size_t> pair = std::minmax(i + 1, k + 1);
    if (!found || pair < *found) found = pair;
  });
  return found;
}

double volume_of(const std::vector<Triangle>& triangles) {
  double volume = 0;
  for (const Triangle& t : triangles) volume += dot(t[0] - triangles[0][0], cross(t[1] - t[0], t[2] - t[0])) / 6;
  return volume;
}

/// Each surface is a solid, or, if it is inside out, a cavity of the smallest solid around it.
Solids solids_of_surfaces(const std::vector<TopoDS_Shell>& shells, std::vector<std::vector<Triangle>> triangles) {
  const BRep_Builder builder;
  std::vector<double> volumes;
  for (const auto& surface : triangles) volumes.push_back(volume_of(surface));
  std::vector<std::size_t> owners(shells.size());
  std::iota(owners.begin(), owners.end(), std::size_t{0});
  if (std::ranges::any_of(volumes, [](double v) { return v < 0; })) {
    std::vector<std::size_t> solids;
    std::vector<FacetTree> trees;
    for (std::size_t s = 0; s < shells.size(); ++s) {
      if (volumes[s] < 0) continue;
      solids.push_back(s);
      trees.emplace_back(std::move(triangles[s]));
    }
    for (std::size_t s = 0; s < shells.size(); ++s) {
      double smallest = HUGE_VAL;
      for (std::size_t k = 0; volumes[s] < 0 && k < solids.size(); ++k)
        if (volumes[solids[k]] < smallest && trees[k].contains(triangles[s][0][0])) {
          owners[s] = solids[k];
          smallest = volumes[solids[k]];
        }
    }
  }
  std::vector<TopoDS_Solid> made(shells.size());
  for (std::size_t s = 0; s < shells.size(); ++s) {
    TopoDS_Solid& solid = made[owners[s]];
    if (solid.IsNull()) builder.MakeSolid(solid);
    builder.Add(solid, shells[s]);
  }
  Solids out;
  for (const TopoDS_Solid& solid : made)
    if (!solid.IsNull()) out.push_back(solid);
  return out;
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
  std::vector<std::vector<Triangle>> triangles(count);
  for (TopoDS_Shell& shell : shells) builder.MakeShell(shell);
  Facets facets(*mesh);
  for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
    const TopoDS_Face face = facets.face(mesh->triangles[i]);
    if (face.IsNull()) {
      context.report(Code::import_not_closed, where, {name, "triangle " + std::to_string(i + 1) + " has no area"});
      return {};
    }
    builder.Add(shells[surfaces[i]], face);
    const auto& [a, b, c] = mesh->triangles[i];
    triangles[surfaces[i]].push_back({mesh->points[a], mesh->points[b], mesh->points[c]});
  }
  if (const auto pair = crossing(*mesh, surfaces)) {
    context.report(Code::import_overlaps, where,
                   {name, "triangles " + std::to_string(pair->first) + " and " + std::to_string(pair->second) +
                              " of one surface cross each other"});
    return {};
  }
  for (TopoDS_Shell& shell : shells) shell.Closed(true);
  return solids_of_surfaces(shells, std::move(triangles));
}

}  // namespace meso::brep
