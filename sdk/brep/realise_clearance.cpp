// SPDX-License-Identifier: Apache-2.0
#include "realise_clearance.hpp"

#include <BRepExtrema_DistShapeShape.hxx>
#include <algorithm>
#include <limits>
#include <numbers>

#include "face_moments.hpp"

namespace meso::brep {
namespace {

double distance_to_box(const Box3& box, Vec3 p) {
  Vec3 d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = std::max({box.min[i] - p[i], 0.0, p[i] - box.max[i]});
  return norm(d);
}

using Corners = std::array<Vec3, 3>;

/// More than `margin` away all over the triangle? Empty if that is not decided without a closer look.
std::optional<bool> is_away_at_once(const CarrierSurface& surface, const Corners& t, double margin, int side) {
  const Vec3 centre = (t[0] + t[1] + t[2]) / 3;
  const double at_centre = surface.signed_distance(centre);
  if (side * at_centre <= margin) return false;
  if (!surface.is_convex_on(t)) {
    const double reach = std::max({norm(t[0] - centre), norm(t[1] - centre), norm(t[2] - centre)});
    return side * at_centre > reach + margin ? std::optional(true) : std::nullopt;
  }
  const auto corner_away = [&](Vec3 p) { return side * surface.signed_distance(p) > margin; };
  if (!std::ranges::all_of(t, corner_away)) return false;
  if (side < 0) return true;                    // a convex function is largest in a corner
  const Vec3 slope = surface.gradient(centre);  // and nowhere below its tangent
  const auto tangent_away = [&](Vec3 p) { return at_centre + dot(slope, p - centre) > margin; };
  return std::ranges::all_of(t, tangent_away) ? std::optional(true) : std::nullopt;
}

/// Halves a triangle along its edges until the surface is provably away from each piece.
bool is_away(const CarrierSurface& surface, const Corners& t, double margin, int side, int depth) {
  if (const auto answer = is_away_at_once(surface, t, margin, side)) return *answer;
  if (depth == 0) return false;
  const Vec3 ab = (t[0] + t[1]) / 2, bc = (t[1] + t[2]) / 2, ca = (t[2] + t[0]) / 2;
  return is_away(surface, {t[0], ab, ca}, margin, side, depth - 1) &&
         is_away(surface, {ab, t[1], bc}, margin, side, depth - 1) &&
         is_away(surface, {ca, bc, t[2]}, margin, side, depth - 1) &&
         is_away(surface, {ab, bc, ca}, margin, side, depth - 1);
}

bool is_away(const CarrierSurface& surface, const CoarseMesh& mesh, double margin, int side) {
  constexpr int depth = 5;
  return std::ranges::all_of(mesh.triangles, [&](const auto& t) {
    return is_away(surface, {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, margin, side, depth);
  });
}

Box3 quick_box(const TopoDS_Shape& shape) {
  Bnd_Box bounds;
  BRepBndLib::Add(shape, bounds, false);
  return {to_vec(bounds.CornerMin()), to_vec(bounds.CornerMax())};
}

/// By formula, if the solid is one.
bool add_ellipsoid(const TopoDS_Shape& solid, double fineness, CoarseMesh& mesh) {
  TopExp_Explorer it(solid, TopAbs_FACE);
  const auto ellipsoid = it.More() ? ellipsoid_of(TopoDS::Face(it.Current())) : std::nullopt;
  it.Next();
  if (!ellipsoid || it.More()) return false;
  const Box3 box = box_of(*ellipsoid);
  const double deflection = 0.01 * fineness * norm(box.max - box.min);
  mesh.error = std::max(mesh.error, deflection);
  const Triangulation triangles = mesh_of(*ellipsoid, deflection, std::numbers::pi);
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (const MeshPoint& p : triangles.points) mesh.points.push_back(p.point);
  for (const auto& [a, b, c] : triangles.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return true;
}

}  // namespace

CarrierSurface::CarrierSurface(const TopoDS_Face& face) : face_(face) {
  const BRepAdaptor_Surface surface(face, false);
  type_ = surface.GetType();
  const auto place = [&](const gp_Ax3& frame) {
    origin_ = to_vec(frame.Location());
    axis_ = to_vec(frame.Direction());
  };
  switch (type_) {
    case GeomAbs_Plane:
      place(surface.Plane().Position());
      break;
    case GeomAbs_Cylinder:
      place(surface.Cylinder().Position());
      radius_ = surface.Cylinder().Radius();
      break;
    case GeomAbs_Cone:
      place(surface.Cone().Position());
      origin_ = to_vec(surface.Cone().Apex());
      sine_ = std::fabs(std::sin(surface.Cone().SemiAngle()));
      cosine_ = std::cos(surface.Cone().SemiAngle());
      break;
    case GeomAbs_Sphere:
      place(surface.Sphere().Position());
      radius_ = surface.Sphere().Radius();
      break;
    case GeomAbs_Torus:
      place(surface.Torus().Position());
      radius_ = surface.Torus().MajorRadius();
      minor_ = surface.Torus().MinorRadius();
      break;
    default:
      type_ = GeomAbs_OtherSurface;
  }
  if (const auto ellipsoid = ellipsoid_of(face)) {
    is_closed_ = true;
    if (type_ == GeomAbs_OtherSurface) be(*ellipsoid);
  }
  // The tight box of a B-spline is an optimisation problem; that of its poles contains it, too.
  box_ = type_ == GeomAbs_OtherSurface && !is_closed_ ? quick_box(face) : face_box(face);
}

void CarrierSurface::be(const Ellipsoid& ellipsoid) {
  origin_ = ellipsoid.map.translation;
  minor_ = radii_of(ellipsoid).z;
  const Mat3& m = ellipsoid.map.linear;
  const Mat3 cofactors = Mat3::from_columns(cross(m.column(1), m.column(2)), cross(m.column(2), m.column(0)),
                                            cross(m.column(0), m.column(1)));
  ball_from_ellipsoid_ = transposed(cofactors);
  for (double& c : ball_from_ellipsoid_->m) c /= determinant(m);
}

double CarrierSurface::signed_distance(Vec3 p) const {
  if (ball_from_ellipsoid_) return minor_ * (norm(*ball_from_ellipsoid_ * (p - origin_)) - 1);
  const Vec3 d = p - origin_;
  const double along = dot(d, axis_), across = norm(d - along * axis_);
  switch (type_) {
    case GeomAbs_Plane:
      return along;
    case GeomAbs_Cylinder:
      return across - radius_;
    case GeomAbs_Cone:
      return across * cosine_ - std::fabs(along) * sine_;
    case GeomAbs_Sphere:
      return norm(d) - radius_;
    case GeomAbs_Torus:
      return std::hypot(across - radius_, along) - minor_;
    default:
      return distance_to_box(box_, p);
  }
}

Vec3 CarrierSurface::gradient(Vec3 p) const {
  const auto unit = [](Vec3 v) { return norm(v) > 0 ? v / norm(v) : Vec3{}; };
  const Vec3 d = p - origin_;
  if (ball_from_ellipsoid_) return minor_ * (transposed(*ball_from_ellipsoid_) * unit(*ball_from_ellipsoid_ * d));
  const double along = dot(d, axis_);
  const Vec3 outwards = unit(d - along * axis_);
  switch (type_) {
    case GeomAbs_Plane:
      return axis_;
    case GeomAbs_Cylinder:
      return outwards;
    case GeomAbs_Cone:
      return cosine_ * outwards - std::copysign(sine_, along) * axis_;
    default:
      return unit(d);
  }
}

bool CarrierSurface::is_convex_on(const std::array<Vec3, 3>& points) const {
  if (type_ == GeomAbs_Cone) {  // one nappe is, both are not
    const auto is_above = [this](Vec3 p) { return dot(p - origin_, axis_) > 0; };
    return is_above(points[0]) == is_above(points[1]) && is_above(points[1]) == is_above(points[2]);
  }
  return ball_from_ellipsoid_ || type_ == GeomAbs_Plane || type_ == GeomAbs_Cylinder || type_ == GeomAbs_Sphere;
}

CoarseMesh CoarseMesh::placed(const Affine& placement) const {
  CoarseMesh mesh = *this;
  for (Vec3& p : mesh.points) p = placement * p;
  return mesh;
}

namespace {

/// False: a face has no triangles.
bool add_triangles(const TopoDS_Shape& meshed, CoarseMesh& mesh) {
  for (TopExp_Explorer it(meshed, TopAbs_FACE); it.More(); it.Next()) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) facets = BRep_Tool::Triangulation(TopoDS::Face(it.Current()), location);
    if (facets.IsNull()) return false;
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (int i = 1; i <= facets->NbNodes(); ++i)
      mesh.points.push_back(to_vec(facets->Node(i).Transformed(location.Transformation())));
    for (int i = 1; i <= facets->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      facets->Triangle(i).Get(a, b, c);
      const auto index = [&](int node) { return first + static_cast<std::uint32_t>(node) - 1; };
      mesh.triangles.push_back({index(a), index(b), index(c)});
    }
  }
  return true;
}

}  // namespace

CoarseMesh coarse_mesh(const Solids& solids, double fineness) {
  constexpr int most_attempts = 4;  // where the mesher fails at a narrow place, it mostly does not with shorter chords
  CoarseMesh mesh;
  for (const TopoDS_Shape& solid : solids) {
    if (add_ellipsoid(solid, fineness, mesh)) continue;
    const Box3 box = quick_box(solid);
    double deflection = 0.01 * fineness * norm(box.max - box.min), angle = 0.3;
    mesh.error = std::max(mesh.error, 2 * deflection);  // the mesher's deflection is aimed at, not guaranteed
    bool done = false;
    for (int attempt = 0; attempt < most_attempts && !done; ++attempt, deflection /= 3, angle /= 1.6) {
      const TopoDS_Shape copy = BRepBuilderAPI_Copy(solid).Shape();  // the original may get a finer mesh later
      BRepMesh_IncrementalMesh(copy, deflection, false, angle);
      CoarseMesh with = mesh;
      done = add_triangles(copy, with);
      if (done) mesh = std::move(with);
    }
    if (!done) return {.error = std::numeric_limits<double>::infinity()};
  }
  return mesh;
}

int proven_side(const CarrierSurface& surface, const CoarseMesh& mesh, double gap) {
  if (mesh.points.empty()) return 0;
  const double margin = mesh.error + gap;
  const int side = surface.signed_distance(mesh.points.front()) > 0 ? 1 : -1;
  const bool corners_clear =
      std::ranges::all_of(mesh.points, [&](Vec3 p) { return side * surface.signed_distance(p) > margin; });
  if (!corners_clear) return 0;
  return is_away(surface, mesh, margin, side) ? side : 0;
}

bool proven_apart(const std::vector<CarrierSurface>& surfaces, const CoarseMesh& first, const CoarseMesh& second) {
  // The first body touches its own surfaces: it may reach over them by `slack`, and the second must stay beyond that.
  const double slack = 2 * first.error;
  return std::ranges::any_of(surfaces, [&](const CarrierSurface& surface) {
    const int side = proven_side(surface, second, slack + first.error + clear_distance);
    return side != 0 && is_away(surface, first, -slack, -side);
  });
}

double exact_distance(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  BRepExtrema_DistShapeShape distance(a, b);
  if (!distance.IsDone()) throw Standard_Failure("the distance of two bodies cannot be found");
  return distance.Value();
}

}  // namespace meso::brep
