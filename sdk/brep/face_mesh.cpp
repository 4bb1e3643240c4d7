// SPDX-License-Identifier: Apache-2.0
#include "face_mesh.hpp"

#include <Poly_PolygonOnTriangulation.hxx>
#include <Standard_OutOfMemory.hxx>
#include <algorithm>
#include <bit>
#include <map>

#include "ellipsoid.hpp"
#include "fit_triangles.hpp"
#include "plane_mesh.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t many_loops = 10;
constexpr double same_parameter = 1e-9;  ///< of the edge

class FaceMesher {
 public:
  FaceMesher(const MeshTolerance& tolerance, const TopTools_IndexedMapOfShape& edges,
             const TopTools_IndexedMapOfShape& vertices, Template& geometry)
      : tolerance_(tolerance),
        edges_(edges),
        vertices_(vertices),
        geometry_(geometry),
        edge_points_(static_cast<std::size_t>(edges.Extent()) + 1),
        edge_at_(edge_points_.size()) {}

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
    std::vector<std::vector<Border>> borders(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (ellipsoids[f])
        geometry_.faces[f].mesh = mesh_of(*ellipsoids[f], tolerance_.deflection_mm, tolerance_.angle);
      else if (!is_plane[f])
        borders[f] = taken_from(faces_[f], geometry_.faces[f].mesh);
    for (const auto& of_face : borders)
      for (const Border& border : of_face) share(border);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (!is_plane[f] && !ellipsoids[f]) settle(borders[f], geometry_.faces[f].mesh);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (is_plane[f]) geometry_.faces[f].mesh = between_loops(f);
    if (!is_closed()) return false;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (FaceTemplate& face = geometry_.faces[f]; !ellipsoids[f] && !std::holds_alternative<Plane>(face.surface))
        fit_triangles(face.mesh, to_geom(face.surface), {}, tolerance_.deflection_mm);
    return true;
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
      settle(taken_from(faces_[face], mesh), mesh);
      return mesh;
    }
    mesh.triangles = std::move(*triangles);
    return mesh;
  }

  /// The points of one edge in the triangles of one face, along the edge's forward direction.
  struct Border {
    std::size_t edge = 0;  ///< index in edges_
    std::vector<std::uint32_t> nodes;
    std::vector<double> at;  ///< parameters
    std::vector<MeshPoint> points;
  };

  /// OpenCASCADE's triangles, and where they end.
  std::vector<Border> taken_from(const TopoDS_Face& face, Triangulation& result) const {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) throw Standard_Failure("a face could not be meshed");
    result = {};
    for (int i = 1; i <= mesh->NbNodes(); ++i)
      result.points.push_back({.point = to_vec(mesh->Node(i).Transformed(location.Transformation()))});
    const bool flip = (face.Orientation() == TopAbs_REVERSED) != location.Transformation().IsNegative();
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      mesh->Triangle(i).Get(a, b, c);
      if (flip) std::swap(b, c);
      result.triangles.push_back(
          {static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1), static_cast<std::uint32_t>(c - 1)});
    }
    std::vector<Border> borders;
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      if (polygon.IsNull() || !polygon->HasParameters()) throw Standard_Failure("an edge could not be meshed");
      Border& border = borders.emplace_back();
      border.edge = static_cast<std::size_t>(edges_.FindIndex(edge));
      for (int k = 1; k <= polygon->NbNodes(); ++k) {
        border.nodes.push_back(static_cast<std::uint32_t>(polygon->Node(k) - 1));
        border.at.push_back(polygon->Parameter(k));
        border.points.push_back(result.points[border.nodes.back()]);
      }
    }
    return borders;
  }

  /// An edge has the points of the face that has most: OpenCASCADE puts more where the parameters of a face run close,
  /// as they do at the pole of a ball, and for that face only.
  void share(const Border& border) {
    if (border.points.size() <= edge_points_[border.edge].size()) return;
    const TopoDS_Edge edge = TopoDS::Edge(edges_(static_cast<int>(border.edge)).Oriented(TopAbs_FORWARD));
    const auto place = [&](const TopoDS_Vertex& vertex) {
      return geometry_.vertices[static_cast<std::size_t>(vertices_.FindIndex(vertex) - 1)];
    };
    const Vec3 first = place(TopExp::FirstVertex(edge));
    std::vector<Vec3>& shared = edge_points_[border.edge];
    shared.clear();
    for (const MeshPoint& p : border.points) shared.push_back(BRep_Tool::Degenerated(edge) ? first : p.point);
    shared.front() = first;
    shared.back() = place(TopExp::LastVertex(edge));
    edge_at_[border.edge] = border.at;
  }

  /// Puts the triangles' borders on the points that edges share. Triangles that an edge of zero length folds up go.
  void settle(const std::vector<Border>& borders, Triangulation& mesh) {
    for (const Border& border : borders) {
      if (edge_points_[border.edge].empty()) share(border);
      const std::vector<Vec3>& shared = edge_points_[border.edge];
      const std::vector<double>& at = edge_at_[border.edge];
      std::size_t own = 0;
      std::uint32_t last = border.nodes.front();
      for (std::size_t k = 0; k < shared.size(); ++k) {
        if (own == border.nodes.size()) throw Standard_Failure("faces disagree on the mesh of their edge");
        const bool has_it = shared.size() == border.nodes.size() ||
                            std::fabs(border.at[own] - at[k]) <= same_parameter * (at.back() - at.front());
        if (has_it) {
          last = border.nodes[own++];
          mesh.points[last].point = shared[k];
        } else {
          last = divide_segment(mesh, last, border.nodes[own], shared[k]);
        }
      }
      if (own != border.nodes.size()) throw Standard_Failure("faces disagree on the mesh of their edge");
    }
    std::erase_if(mesh.triangles, [&](const auto& t) {
      const Vec3 &p = mesh.points[t[0]].point, &q = mesh.points[t[1]].point, &r = mesh.points[t[2]].point;
      return p == q || q == r || r == p;
    });
  }

  /// A point on the border between two others.
  static std::uint32_t divide_segment(Triangulation& mesh, std::uint32_t from, std::uint32_t to, Vec3 point) {
    const auto fresh = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.push_back({.point = point});
    for (auto& t : mesh.triangles) {
      const auto a = std::ranges::find(t, from), b = std::ranges::find(t, to);
      if (a == t.end() || b == t.end()) continue;
      auto half = t;
      half[static_cast<std::size_t>(a - t.begin())] = fresh;
      *b = fresh;
      mesh.triangles.push_back(half);
      return fresh;
    }
    throw Standard_Failure("faces disagree on the mesh of their edge");
  }

  const MeshTolerance& tolerance_;
  const TopTools_IndexedMapOfShape& edges_;
  const TopTools_IndexedMapOfShape& vertices_;
  Template& geometry_;
  std::vector<TopoDS_Face> faces_;
  std::vector<bool> is_divided_;                ///< edges that get points from a face with few loops
  std::vector<std::vector<Vec3>> edge_points_;  ///< by index in edges_, along the edge's forward direction
  std::vector<std::vector<double>> edge_at_;    ///< their parameters
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
