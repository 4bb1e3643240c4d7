// SPDX-License-Identifier: Apache-2.0
#include "face_mesh.hpp"

#include <GCPnts_TangentialDeflection.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Standard_OutOfMemory.hxx>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "ellipsoid.hpp"
#include "face_border.hpp"
#include "fit_triangles.hpp"
#include "plane_mesh.hpp"
#include "unrolled_mesh.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t many_loops = 10;
constexpr double same_parameter = 1e-9;  ///< of the edge

/// Whether every segment is gone along as often in one direction as in the other: then sums of hashes cancel.
class SegmentSum {
 public:
  void add(Vec3 from, Vec3 to) { add(hash(from), hash(to)); }
  void add(const Triangulation& mesh) {
    hashes_.clear();
    for (const MeshPoint& p : mesh.points) hashes_.push_back(hash(p.point));
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) add(hashes_[t[k]], hashes_[t[(k + 1) % 3]]);
  }
  [[nodiscard]] bool is_zero() const { return sum_ == 0; }

 private:
  static std::uint64_t hash(Vec3 p) {
    std::uint64_t h = 0;
    for (const double c : {p.x, p.y, p.z})
      h = std::rotl((h ^ std::bit_cast<std::uint64_t>(c + 0.0)) * 0x9e3779b97f4a7c15u, 29);
    return h;
  }
  void add(std::uint64_t a, std::uint64_t b) {
    if (a == b) return;
    const std::uint64_t mixed = (std::min(a, b) * 0xbf58476d1ce4e5b9u) ^ std::rotl(std::max(a, b), 31);
    sum_ += a < b ? mixed : 0 - mixed;
  }

  std::vector<std::uint64_t> hashes_;
  std::uint64_t sum_ = 0;
};

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
    std::vector<Made> made;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (ellipsoids[f])
        geometry_.faces[f].mesh = mesh_of(*ellipsoids[f], tolerance_.deflection_mm, tolerance_.angle);
      else if (!is_plane[f])
        made.push_back(made_of(f));
    for (const Made& face : made)
      for (const Border& border : face.borders) share(border);
    while (!settle(made)) {
    }
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (is_plane[f]) geometry_.faces[f].mesh = between_loops(f);
    if (!is_closed()) return false;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (FaceTemplate& face = geometry_.faces[f]; !ellipsoids[f] && !std::holds_alternative<Plane>(face.surface))
        fit_triangles(face.mesh, to_geom(face.surface), {}, tolerance_.deflection_mm);
    return true;
  }

 private:
  /// The points of one edge in the triangles of one face, along the edge's forward direction.
  struct Border {
    std::size_t edge = 0;  ///< index in edges_
    bool reversed = false;
    std::vector<std::uint32_t> nodes;
    std::vector<double> at;  ///< parameters
    std::vector<MeshPoint> points;
  };

  /// What OpenCASCADE has made of a face; nothing where that does not reach its edges, or is folded.
  struct Made {
    std::size_t face = 0;
    bool is_lost = false;
    Triangulation mesh;
    std::vector<Border> borders;
    std::vector<std::size_t> settled_on{};  ///< points of its edges, when it was put on them
  };

  [[nodiscard]] Made made_of(std::size_t face) const {
    Made out{.face = face};
    try {
      out.borders = taken_from(faces_[face], out.mesh);
    } catch (const Standard_OutOfMemory&) {
      throw;
    } catch (const Standard_Failure&) {
      out.is_lost = true;
      out.borders.clear();
    }
    return out;
  }

  /// False where more faces are lost: what is put in their place may need points on edges of the others.
  [[nodiscard]] bool settle(std::vector<Made>& made) {
    insert_needed(made);
    bool is_done = true;
    for (Made& face : made) {
      Triangulation& mesh = geometry_.faces[face.face].mesh;
      if (face.is_lost) {
        auto between = between_edges(faces_[face.face]);
        if (!between) throw Standard_Failure("a face could not be meshed");
        mesh = std::move(between->mesh);
        continue;
      }
      std::vector<std::size_t> points;
      for (const Border& border : face.borders) points.push_back(edge_points_[border.edge].size());
      if (points == face.settled_on && !points.empty()) continue;
      face.settled_on = std::move(points);
      mesh = face.mesh;
      try {
        settle(face.borders, mesh);
        face.is_lost = !ends_at_edges(face.borders, mesh) || is_folded(face);
      } catch (const Standard_OutOfMemory&) {
        throw;
      } catch (const Standard_Failure&) {
        face.is_lost = true;
      }
      is_done = is_done && !face.is_lost;
    }
    return is_done;
  }

  /// Points beside those that a chord of a lost face would pass.
  void insert_needed(const std::vector<Made>& made) {
    constexpr int most_rounds = 4;
    for (int round = 0; round < most_rounds; ++round) {
      std::vector<PolygonPoint> needed;
      for (const Made& face : made) {
        if (!face.is_lost) continue;
        if (const auto mesh = between_edges(faces_[face.face]))
          for (const NeededPoint& p : mesh->needed)
            needed.push_back({.edge = static_cast<std::uint32_t>(edges_.FindIndex(p.edge)),
                              .segment = p.segment,
                              .at = p.at,
                              .parameter = p.parameter,
                              .point = p.point});
      }
      if (needed.empty()) return;
      for (const PolygonPoint& p : apart_from_last(std::move(needed))) {
        const auto at = static_cast<std::ptrdiff_t>(p.segment) + 1;
        edge_points_[p.edge].insert(edge_points_[p.edge].begin() + at, p.point);
        edge_at_[p.edge].insert(edge_at_[p.edge].begin() + at, p.parameter);
      }
    }
  }

  [[nodiscard]] std::optional<BorderedMesh> between_edges(const TopoDS_Face& face) {
    return bordered_mesh(face, geometry_, [&](const TopoDS_Edge& edge) {
      const auto e = static_cast<std::size_t>(edges_.FindIndex(edge));
      if (edge_points_[e].empty()) share(divided(TopoDS::Edge(edges_(static_cast<int>(e)).Oriented(TopAbs_FORWARD))));
      EdgePoints out{.points = {}, .parameters = edge_at_[e]};
      for (const Vec3 p : edge_points_[e]) out.points.push_back({.point = p});
      return out;
    });
  }

  /// An edge between lost faces only.
  [[nodiscard]] Border divided(const TopoDS_Edge& edge) const {
    Border out{.edge = static_cast<std::size_t>(edges_.FindIndex(edge))};
    const auto add = [&](double parameter, Vec3 point) {
      out.at.push_back(parameter);
      out.points.push_back({.point = point});
    };
    double first = 0, last = 0;
    BRep_Tool::Range(edge, first, last);
    if (BRep_Tool::Degenerated(edge)) {
      add(first, {});
      add(last, {});
      return out;
    }
    const GCPnts_TangentialDeflection points(BRepAdaptor_Curve(edge), tolerance_.angle, tolerance_.deflection_mm, 3);
    for (int i = 1; i <= points.NbPoints(); ++i) add(points.Parameter(i), to_vec(points.Value(i)));
    return out;
  }

  [[nodiscard]] bool ends_at_edges(const std::vector<Border>& borders, const Triangulation& mesh) const {
    SegmentSum sum;
    sum.add(mesh);
    for (const Border& border : borders) {
      const std::vector<Vec3>& points = edge_points_[border.edge];
      for (std::size_t k = 0; k + 1 < points.size(); ++k)
        sum.add(points[border.reversed ? k : k + 1], points[border.reversed ? k + 1 : k]);
    }
    return sum.is_zero();
  }

  [[nodiscard]] bool is_folded(const Made& made) const {
    if (std::holds_alternative<Plane>(geometry_.faces[made.face].surface)) return false;
    const Triangulation& mesh = geometry_.faces[made.face].mesh;
    std::vector<Vec3> places;
    for (const MeshPoint& p : mesh.points) places.push_back(p.point);
    return brep::is_folded(faces_[made.face], places, mesh.triangles, tolerance_.deflection_mm);
  }

  [[nodiscard]] bool is_closed() const {
    SegmentSum sum;
    for (const FaceTemplate& face : geometry_.faces) sum.add(face.mesh);
    return sum.is_zero();
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
      if (!bounds(edge)) continue;
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      if (polygon.IsNull() || !polygon->HasParameters()) throw Standard_Failure("an edge could not be meshed");
      Border& border = borders.emplace_back();
      border.edge = static_cast<std::size_t>(edges_.FindIndex(edge));
      border.reversed = edge.Orientation() == TopAbs_REVERSED;
      for (int k = 1; k <= polygon->NbNodes(); ++k) {
        if (polygon->Node(k) < 1) throw Standard_Failure("an edge could not be meshed");
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
