// SPDX-License-Identifier: Apache-2.0
#include "face_mesh.hpp"

#include <Poly_PolygonOnTriangulation.hxx>
#include <Standard_OutOfMemory.hxx>
#include <bit>
#include <map>

#include "ellipsoid.hpp"
#include "plane_mesh.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t many_loops = 10;

class FaceMesher {
 public:
  FaceMesher(const MeshTolerance& tolerance, const TopTools_IndexedMapOfShape& edges,
             const TopTools_IndexedMapOfShape& vertices, Template& geometry)
      : tolerance_(tolerance),
        edges_(edges),
        vertices_(vertices),
        geometry_(geometry),
        edge_points_(static_cast<std::size_t>(edges.Extent()) + 1) {}

  /// Throws Standard_Failure; false: a face's triangles do not reach its edges.
  [[nodiscard]] bool mesh(const TopoDS_Shell& shell) {
    for (TopExp_Explorer it(shell, TopAbs_FACE); it.More(); it.Next()) faces_.push_back(TopoDS::Face(it.Current()));
    std::vector<bool> is_plane(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) is_plane[f] = has_many_loops(geometry_.faces[f]);
    for (std::size_t f = 0; f < faces_.size(); ++f) is_plane[f] = is_plane[f] && edges_have_points(f, is_plane);
    TopoDS_Compound others;
    const BRep_Builder builder;
    builder.MakeCompound(others);
    std::vector<std::optional<Ellipsoid>> ellipsoids(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (!is_plane[f] && !(ellipsoids[f] = ellipsoid_of(faces_[f]))) builder.Add(others, faces_[f]);
    BRepMesh_IncrementalMesh(others, tolerance_.deflection_mm, false, tolerance_.angle, true);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (ellipsoids[f])
        geometry_.faces[f].mesh = mesh_of(*ellipsoids[f], tolerance_.deflection_mm, tolerance_.angle);
      else if (!is_plane[f])
        geometry_.faces[f].mesh = taken_from(faces_[f]);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (is_plane[f]) geometry_.faces[f].mesh = between_loops(f);
    return is_closed();
  }

 private:
  /// Every segment is gone along as often in one direction as in the other: sums of hashes cancel.
  [[nodiscard]] bool is_closed() const {
    const auto hash = [](Vec3 p) {
      std::uint64_t h = 0;
      for (const double c : {p.x, p.y, p.z})
        h = std::rotl((h ^ std::bit_cast<std::uint64_t>(c + 0.0)) * 0x9e3779b97f4a7c15u, 29);
      return h;
    };
    std::uint64_t sum = 0;
    std::vector<std::uint64_t> hashes;
    for (const FaceTemplate& face : geometry_.faces) {
      hashes.clear();
      for (const MeshPoint& p : face.mesh.points) hashes.push_back(hash(p.point));
      for (const auto& t : face.mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint64_t a = hashes[t[k]], b = hashes[t[(k + 1) % 3]];
          if (a == b) continue;
          const std::uint64_t mixed = (std::min(a, b) * 0xbf58476d1ce4e5b9u) ^ std::rotl(std::max(a, b), 31);
          sum += a < b ? mixed : 0 - mixed;
        }
    }
    return sum == 0;
  }

  static bool has_many_loops(const FaceTemplate& face) {
    return face.loops.size() >= many_loops && std::holds_alternative<Plane>(face.surface);
  }

  /// Straight edges need no points but their ends; others get theirs from the face across.
  [[nodiscard]] bool edges_have_points(std::size_t face, const std::vector<bool>& is_plane) {
    if (is_divided_.empty()) {
      is_divided_.resize(geometry_.edges.size());
      for (std::size_t f = 0; f < faces_.size(); ++f)
        for (const auto& loop : geometry_.faces[f].loops)
          for (const Coedge& use : loop) is_divided_[use.edge] = is_divided_[use.edge] || !is_plane[f];
    }
    for (const auto& loop : geometry_.faces[face].loops)
      for (const Coedge& use : loop)
        if (!is_divided_[use.edge] && !std::holds_alternative<Line>(geometry_.edges[use.edge].curve)) return false;
    return true;
  }

  Triangulation between_loops(std::size_t face) {
    const FaceTemplate& value = geometry_.faces[face];
    Triangulation mesh;
    std::map<std::uint32_t, std::uint32_t> of_vertex, of_edge;
    std::vector<std::vector<std::uint32_t>> loops;
    const auto add = [&](Vec3 p) {
      mesh.points.push_back({.point = p});
      return static_cast<std::uint32_t>(mesh.points.size() - 1);
    };
    for (const auto& loop : value.loops) {
      std::vector<std::uint32_t>& polygon = loops.emplace_back();
      for (const Coedge& use : loop) {
        const std::vector<Vec3>& inner = edge_points_[use.edge + 1];
        const std::uint32_t vertex = geometry_.edges[use.edge].vertex[use.reversed ? 1 : 0];
        const auto [start, fresh] = of_vertex.try_emplace(vertex);
        if (fresh) start->second = add(geometry_.vertices[vertex]);
        polygon.push_back(start->second);
        const auto [first, unseen] = of_edge.try_emplace(use.edge, static_cast<std::uint32_t>(mesh.points.size()));
        const auto count = inner.size() < 2 ? 0 : static_cast<std::uint32_t>(inner.size()) - 2;
        for (std::uint32_t k = 0; unseen && k < count; ++k) add(inner[k + 1]);
        for (std::uint32_t k = 0; k < count; ++k) polygon.push_back(first->second + (use.reversed ? count - 1 - k : k));
      }
    }
    const AxisFrame& frame = std::get<Plane>(value.surface).frame;
    const Vec3 y = cross(value.reversed ? -frame.z : frame.z, frame.x);
    std::vector<PlanePoint> flat;
    for (const MeshPoint& p : mesh.points)
      flat.push_back({dot(p.point - frame.origin, frame.x), dot(p.point - frame.origin, y)});
    auto triangles = triangulate_between(flat, loops);
    if (!triangles) {
      BRepMesh_IncrementalMesh(faces_[face], tolerance_.deflection_mm, false, tolerance_.angle, true);
      return taken_from(faces_[face]);
    }
    mesh.triangles = std::move(*triangles);
    return mesh;
  }

  /// OpenCASCADE's triangles; those that an edge of zero length folds up are left out.
  Triangulation taken_from(const TopoDS_Face& face) {
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

  void take_edge_points(const TopoDS_Face& face, const TopoDS_Edge& edge, std::vector<MeshPoint>& points) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
    if (polygon.IsNull()) throw Standard_Failure("an edge could not be meshed");
    const int count = polygon->NbNodes();
    const auto node = [&](int k) -> MeshPoint& { return points[static_cast<std::size_t>(polygon->Node(k) - 1)]; };
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const Vec3 first =
        geometry_.vertices[static_cast<std::size_t>(vertices_.FindIndex(TopExp::FirstVertex(forward)) - 1)];
    const Vec3 last =
        geometry_.vertices[static_cast<std::size_t>(vertices_.FindIndex(TopExp::LastVertex(forward)) - 1)];

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

  const MeshTolerance& tolerance_;
  const TopTools_IndexedMapOfShape& edges_;
  const TopTools_IndexedMapOfShape& vertices_;
  Template& geometry_;
  std::vector<TopoDS_Face> faces_;
  std::vector<bool> is_divided_;                ///< edges that get points from a face with few loops
  std::vector<std::vector<Vec3>> edge_points_;  ///< by index in edges_, along the edge's forward direction
};

}  // namespace

// Where the mesher fails at a narrow place, it mostly does not with shorter chords.
void mesh_faces(const TopoDS_Shell& shell, const MeshTolerance& tolerance, const TopTools_IndexedMapOfShape& edges,
                const TopTools_IndexedMapOfShape& vertices, Template& geometry) {
  constexpr int most_attempts = 5;
  MeshTolerance finer = tolerance;
  for (int attempt = 1; attempt <= most_attempts; ++attempt) {
    try {
      if (FaceMesher(finer, edges, vertices, geometry).mesh(shell)) return;
    } catch (const Standard_OutOfMemory&) {
      throw;  // shorter chords take more
    } catch (const Standard_Failure&) {
      if (attempt == most_attempts) throw;
    }
    BRepTools::Clean(shell);
    finer.deflection_mm /= 3;
    finer.angle /= 1.6;
  }
  throw Standard_Failure("the triangles of a body do not close");
}

}  // namespace meso::brep
