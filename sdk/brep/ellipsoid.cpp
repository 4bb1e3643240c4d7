// SPDX-License-Identifier: Apache-2.0
#include "ellipsoid.hpp"

#include <algorithm>
#include <math_Jacobi.hxx>
#include <numbers>

namespace meso::brep {
namespace {

using std::numbers::pi;

const TopoDS_Shape& unit_sphere() {
  static const TopoDS_Shape sphere =
      BRepBuilderAPI_NurbsConvert(BRepPrimAPI_MakeSphere(gp_Ax2(gp::Origin(), gp::DZ()), 1).Solid(), true).Shape();
  return sphere;
}

TopoDS_Face face_of(const TopoDS_Shape& solid) { return TopoDS::Face(TopExp_Explorer(solid, TopAbs_FACE).Current()); }

Handle(Geom_BSplineSurface) spline_of(const TopoDS_Face& face) {
  return Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(face));
}

/// Bounded by nothing but the surface's own seam and poles.
bool is_whole(const TopoDS_Face& face) {
  int edges = 0;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next(), ++edges) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    if (!BRep_Tool::Degenerated(edge) && !BRep_Tool::IsClosed(edge, face)) return false;
  }
  return edges == 4;
}

Affine map_of(const Geom_SphericalSurface& sphere) {
  const gp_Ax3& frame = sphere.Position();
  const double r = sphere.Radius();
  return {
      Mat3::from_columns(r * to_vec(frame.XDirection()), r * to_vec(frame.YDirection()), r * to_vec(frame.Direction())),
      to_vec(frame.Location())};
}

/// Affine maps of a B-spline move its poles and nothing else.
std::optional<Affine> map_of(const Geom_BSplineSurface& surface) {
  static const Handle(Geom_BSplineSurface) sphere = spline_of(face_of(unit_sphere()));
  const int columns = sphere->NbUPoles(), rows = sphere->NbVPoles(), equator = (rows + 1) / 2;
  if (!surface.IsUPeriodic() || surface.NbUPoles() != columns || surface.NbVPoles() != rows) return {};
  const Vec3 south = to_vec(surface.Pole(1, 1)), north = to_vec(surface.Pole(1, rows));
  const Vec3 centre = (south + north) / 2, x = to_vec(surface.Pole(1, equator)) - centre;
  const Vec3 turned = to_vec(sphere->Pole(2, equator));
  const Vec3 y = (to_vec(surface.Pole(2, equator)) - centre - turned.x * x) / turned.y;
  const Affine map{Mat3::from_columns(x, y, (north - south) / 2), centre};
  const double tolerance = 1e-9 * (norm(x) + norm(y) + norm(north - south));
  for (int i = 1; i <= columns; ++i)
    for (int j = 1; j <= rows; ++j)
      if (norm(to_vec(surface.Pole(i, j)) - map * to_vec(sphere->Pole(i, j))) > tolerance ||
          std::fabs(surface.Weight(i, j) - sphere->Weight(i, j)) > 1e-9)
        return {};
  if (surface.NbUKnots() != sphere->NbUKnots()) return {};
  for (int i = 1; i <= sphere->NbUKnots(); ++i)
    if (std::fabs(surface.UKnot(i) - sphere->UKnot(i)) > 1e-9) return {};
  return map;
}

/// Largest in-plane steps of a mesh of the unit sphere, so that its image keeps to both tolerances.
double step_for(Vec3 radii, double deflection, double angle) {
  // A triangle spans at most a diagonal of sqrt(2) steps, and its chord is 1 - cos(half of that) below the sphere. The
  // image turns faster than the sphere where it is sharpest, by no more than the ratio of its longest half axis to its
  // shortest. That ratio counts squared in triangles for a rim that few of them are near: a flat ellipsoid keeps to the
  // angle only as far as sixteen times the triangles that the deflection asks for.
  const double by_deflection = std::sqrt(2) * std::acos(std::max(0.0, 1 - deflection / radii.x));
  return std::min({by_deflection, std::max(angle * radii.z / radii.x, by_deflection / 4), pi / 4});
}

}  // namespace

TopoDS_Shape ellipsoid_solid(const Affine& map) {
  const TopoDS_Shape solid = BRepBuilderAPI_Copy(unit_sphere(), true, false).Shape();
  const TopoDS_Face face = face_of(solid);
  const Handle(Geom_BSplineSurface) surface = spline_of(face);
  const auto image = [&](const gp_Pnt& p) { return to_pnt(map * to_vec(p)); };
  for (int i = 1; i <= surface->NbUPoles(); ++i)
    for (int j = 1; j <= surface->NbVPoles(); ++j) surface->SetPole(i, j, image(surface->Pole(i, j)));
  TopTools_IndexedMapOfShape edges, vertices;
  TopExp::MapShapes(face, TopAbs_EDGE, edges);
  TopExp::MapShapes(face, TopAbs_VERTEX, vertices);
  for (int e = 1; e <= edges.Extent(); ++e) {
    double first = 0, last = 0;
    const auto curve =
        Handle(Geom_BSplineCurve)::DownCast(BRep_Tool::Curve(TopoDS::Edge(edges(e)), first, last));  // null at a pole
    for (int i = 1; !curve.IsNull() && i <= curve->NbPoles(); ++i) curve->SetPole(i, image(curve->Pole(i)));
  }
  const BRep_Builder builder;
  for (int v = 1; v <= vertices.Extent(); ++v) {
    const TopoDS_Vertex& vertex = TopoDS::Vertex(vertices(v));
    builder.UpdateVertex(vertex, image(BRep_Tool::Pnt(vertex)), BRep_Tool::Tolerance(vertex));
  }
  return determinant(map.linear) < 0 ? solid.Reversed() : solid;
}

std::optional<Ellipsoid> ellipsoid_of(const TopoDS_Face& face) {
  const Handle(Geom_Surface) any = BRep_Tool::Surface(face);
  std::optional<Affine> map;
  if (const auto sphere = Handle(Geom_SphericalSurface)::DownCast(any); !sphere.IsNull())
    map = map_of(*sphere);
  else if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(any); !spline.IsNull())
    map = map_of(*spline);
  if (!map || determinant(map->linear) == 0 || !is_whole(face)) return {};
  return Ellipsoid{*map, (face.Orientation() == TopAbs_REVERSED) == (determinant(map->linear) < 0)};
}

Box3 box_of(const Ellipsoid& ellipsoid) {
  const Affine& map = ellipsoid.map;
  const Mat3 squares = map.linear * transposed(map.linear);
  const Vec3 reach{std::sqrt(squares(0, 0)), std::sqrt(squares(1, 1)), std::sqrt(squares(2, 2))};
  return {map.translation - reach, map.translation + reach};
}

Vec3 radii_of(const Ellipsoid& ellipsoid) {
  const Mat3 squares = ellipsoid.map.linear * transposed(ellipsoid.map.linear);
  math_Matrix symmetric(1, 3, 1, 3);
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) symmetric(static_cast<int>(r) + 1, static_cast<int>(c) + 1) = squares(r, c);
  const math_Jacobi eigen(symmetric);
  std::array<double, 3> radii{};
  for (int i = 1; i <= 3; ++i) radii[static_cast<std::size_t>(i) - 1] = std::sqrt(std::max(0.0, eigen.Value(i)));
  std::ranges::sort(radii, std::greater{});
  return {radii[0], radii[1], radii[2]};
}

FaceMoments moments_of(const Ellipsoid& ellipsoid) {
  // Legendre: 2 pi (c^2 + a b (E sin^2 + F cos^2) / sin) with cos = c / a, a >= b >= c.
  const auto [a, b, c] = radii_of(ellipsoid);
  const double cosine = c / a, sine = std::sqrt((1 - cosine) * (1 + cosine)), phi = std::asin(std::min(1.0, sine));
  double area = 4 * pi * a * a;
  if (sine > 1e-8) {
    const double k = std::sqrt(std::clamp((b - c) * (b + c) / ((a - c) * (a + c)), 0.0, 1.0)) * a / b;
    const double modulus = std::min(k, 1.0);
    area = 2 * pi *
           (c * c +
            a * b / sine * (std::ellint_2(modulus, phi) * sine * sine + std::ellint_1(modulus, phi) * cosine * cosine));
  }
  const double volume = (ellipsoid.outward ? 4 : -4) * pi / 3 * std::fabs(determinant(ellipsoid.map.linear));
  return {area, {volume, volume, volume}, {}, volume * ellipsoid.map.translation};
}

Triangulation mesh_of(const Ellipsoid& ellipsoid, double deflection, double angle) {
  const Affine& map = ellipsoid.map;
  const double step = step_for(radii_of(ellipsoid), deflection, angle);
  const auto rings = static_cast<std::uint32_t>(std::ceil(pi / step)), sides = 2 * rings;
  Triangulation mesh;
  mesh.points.push_back({.point = map * Vec3{0, 0, -1}});
  for (std::uint32_t ring = 1; ring < rings; ++ring) {
    const double latitude = -pi / 2 + pi * ring / rings;
    for (std::uint32_t side = 0; side < sides; ++side) {
      const double longitude = 2 * pi * side / sides;
      mesh.points.push_back({.point = map * Vec3{std::cos(latitude) * std::cos(longitude),
                                                 std::cos(latitude) * std::sin(longitude), std::sin(latitude)}});
    }
  }
  const auto north = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.push_back({.point = map * Vec3{0, 0, 1}});
  const bool flip = ellipsoid.outward == (determinant(map.linear) < 0);
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    mesh.triangles.push_back(flip ? std::array{p, r, q} : std::array{p, q, r});
  };
  const auto at = [&](std::uint32_t ring, std::uint32_t side) { return 1 + (ring - 1) * sides + side % sides; };
  for (std::uint32_t side = 0; side < sides; ++side) {
    add(0, at(1, side + 1), at(1, side));
    for (std::uint32_t ring = 1; ring + 1 < rings; ++ring) {
      add(at(ring, side), at(ring, side + 1), at(ring + 1, side + 1));
      add(at(ring, side), at(ring + 1, side + 1), at(ring + 1, side));
    }
    add(at(rings - 1, side), at(rings - 1, side + 1), north);
  }
  return mesh;
}

}  // namespace meso::brep
