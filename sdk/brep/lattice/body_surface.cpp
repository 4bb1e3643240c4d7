// SPDX-License-Identifier: Apache-2.0
#include "lattice/body_surface.hpp"

#include <Poly_PolygonOnTriangulation.hxx>

namespace meso::brep {
namespace {

constexpr std::array<Index3, 3> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Vec3 grown(Vec3 half, double by) { return {half.x + by, half.y + by, half.z + by}; }

Box3 box_of(const Triangle3& triangle) {
  Box3 box;
  for (const Vec3 p : triangle) box.extend(p);
  return box;
}

/// The axes along which both points are on the same wall of the box.
int shared_walls(Vec3 p, Vec3 q, Vec3 centre, Vec3 half, double tolerance) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (const double wall : {centre[i] - half[i], centre[i] + half[i]})
      count += std::fabs(p[i] - wall) <= tolerance && std::fabs(q[i] - wall) <= tolerance;
  return count;
}

}  // namespace

BodySurface::BodySurface(const std::vector<TopoDS_Shape>& body, const CellGrid& grid) : grid_(grid) {
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& solid : body) builder.Add(all, solid);
  body_ = TopoDS::Compound(BRepBuilderAPI_Copy(all).Shape());  // the mesh made here stays with the copy
  const Vec3 size = grid_.size();
  const double deflection = 0.01 * std::fmin(size.x, std::fmin(size.y, size.z));
  BRepMesh_IncrementalMesh(body_, deflection, Standard_False, 0.3, Standard_True);

  touched_.resize(grid_.count());
  places_.assign(grid_.count(), BoxPlace::outside);
  blocked_.assign(grid_.count(), 0);
  for (TopExp_Explorer it(body_, TopAbs_FACE); it.More(); it.Next())
    all_.push_back(read(TopoDS::Face(it.Current()), deflection));
  for (std::uint32_t number = 0; number < all_.size(); ++number) {
    enter(number, all_[number]);
    std::vector<Triangle3> triangles;
    for (std::size_t t = 0; t < all_[number].triangles.size(); ++t) triangles.push_back(all_[number].triangle(t));
    probe_.add_group(std::move(triangles));
  }
  fill_blocks();
}

/// By OpenCASCADE: a box's centre may be closer to the surface than triangles tell.
bool BodySurface::encloses(Vec3 p) const {
  for (TopExp_Explorer it(body_, TopAbs_SOLID); it.More(); it.Next())
    if (BRepClass3d_SolidClassifier(it.Current(), to_pnt(p), Precision::Confusion()).State() == TopAbs_IN) return true;
  return false;
}

BodySurface::Face BodySurface::read(const TopoDS_Face& face, double deflection) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) throw Standard_Failure("a face of the body could not be meshed");
  const gp_Trsf& move = location.Transformation();
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  Face out;
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    out.nodes.push_back(to_vec(mesh->Node(i).Transformed(move)));
    const gp_Pnt2d at = mesh->UVNode(i);
    out.parameters.push_back({at.X(), at.Y()});
  }
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (reversed) std::swap(b, c);
    out.triangles.push_back(
        {static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1), static_cast<std::uint32_t>(c - 1)});
  }
  const BRepAdaptor_Surface surface(face);
  out.planar = surface.GetType() == GeomAbs_Plane;
  if (out.planar) {
    out.normal = to_vec(surface.Plane().Axis().Direction());
    out.offset = dot(out.normal, to_vec(surface.Plane().Location()));
  }
  // The mesher aims at the deflection and does not promise it.
  bool straight = true;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
    if (polygon.IsNull()) throw Standard_Failure("an edge of the body could not be meshed");
    Edge& value = out.edges.emplace_back();
    for (int i = 1; i <= polygon->NbNodes(); ++i)
      value.nodes.push_back(static_cast<std::uint32_t>(polygon->Node(i) - 1));
    for (int i = 1; polygon->HasParameters() && i <= polygon->NbNodes(); ++i) value.at.push_back(polygon->Parameter(i));
    value.seam = BRep_Tool::IsClosed(edge, face);
    const bool line = BRepAdaptor_Curve(edge).GetType() == GeomAbs_Line;
    value.reach = line ? 0 : 3 * deflection;
    straight = straight && line;
  }
  out.reach = out.planar && straight ? 0 : 3 * deflection;
  return out;
}

void BodySurface::enter(std::uint32_t number, const Face& face) {
  const Vec3 half = 0.5 * grid_.size();
  const double eps = grid_.tolerance, by = face.reach + eps;
  for (std::size_t t = 0; t < face.triangles.size(); ++t) {
    const Triangle3 triangle = face.triangle(t);
    grid_.visit_near(box_of(triangle), by, [&](const Index3& cell) {
      std::vector<std::uint32_t>& touched = touched_[grid_.slot(cell)];
      BoxPlace& place = places_[grid_.slot(cell)];
      const bool known = !touched.empty() && touched.back() == number;
      if (known && place == BoxPlace::crossing) return;
      const Vec3 centre = grid_.centre(cell);
      if (face.planar && plane_gap(face.normal, face.offset, centre, half) > eps) return;
      if (!overlaps(triangle, centre, grown(half, by))) return;
      if (!known) touched.push_back(number);
      const bool through = !face.planar || (plane_gap(face.normal, face.offset, centre, half) < -eps &&
                                            overlaps(triangle, centre, grown(half, face.reach - eps)));
      if (through || (!known && divides_a_wall(face, cell)))
        place = BoxPlace::crossing;
      else
        block_walls(face, cell);
    });
  }
}

/// An edge of the face in a wall, and not along the wall's border: the wall is divided there, and the cell's solid with
/// it.
bool BodySurface::divides_a_wall(const Face& face, const Index3& cell) const {
  const Vec3 centre = grid_.centre(cell), half = 0.5 * grid_.size();
  const double eps = grid_.tolerance;
  for (const Edge& edge : face.edges)
    for (std::size_t i = 0; i + 1 < edge.nodes.size(); ++i) {
      const auto part =
          clipped(face.nodes[edge.nodes[i]], face.nodes[edge.nodes[i + 1]], centre, grown(half, edge.reach + eps));
      if (!part) continue;
      if (edge.reach > 0) return true;
      const int border = norm(part->second - part->first) > 4 * eps ? 2 : 3;
      if (shared_walls(part->first, part->second, centre, half, 4 * eps) < border) return true;
    }
  return false;
}

void BodySurface::block_walls(const Face& face, const Index3& cell) {
  if (!face.planar) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::fabs(face.normal[axis]) < 1 - 1e-12) continue;
    const double at = face.offset / face.normal[axis], low = grid_.origin(cell)[axis];
    if (std::fabs(at - low - grid_.size()[axis]) <= 2 * grid_.tolerance)
      blocked_[grid_.slot(cell)] |= static_cast<std::uint8_t>(1u << axis);
  }
}

/// A plane in the wall between two boxes parts them even where it touches them at a border only: more blocks, not wrong
/// ones.
void BodySurface::fill_blocks() {
  std::vector<bool> seen(grid_.count());
  std::vector<Index3> open;
  grid_.visit_near({grid_.origin(grid_.min), grid_.origin(grid_.max) + grid_.size()}, 0, [&](const Index3& start) {
    if (seen[grid_.slot(start)] || place(start) == BoxPlace::crossing) return;
    const BoxPlace block = encloses(grid_.centre(start)) ? BoxPlace::inside : BoxPlace::outside;
    seen[grid_.slot(start)] = true;
    open.assign(1, start);
    while (!open.empty()) {
      const Index3 cell = open.back();
      open.pop_back();
      places_[grid_.slot(cell)] = block;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int sign : {-1, 1}) {
          Index3 next = cell;
          next[axis] += sign * steps[axis][axis];
          if (next[axis] < grid_.min[axis] || next[axis] > grid_.max[axis]) continue;
          const Index3& low = sign > 0 ? cell : next;
          if (blocked_[grid_.slot(low)] >> axis & 1) continue;
          if (seen[grid_.slot(next)] || place(next) == BoxPlace::crossing) continue;
          seen[grid_.slot(next)] = true;
          open.push_back(next);
        }
    }
  });
}

}  // namespace meso::brep
