// SPDX-License-Identifier: Apache-2.0
#include "test_bodies.hpp"

#include <numbers>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

TopoDS_Shape ellipsoid(double a, double b, double c) {
  gp_GTrsf stretch;
  stretch.SetValue(1, 1, a);
  stretch.SetValue(2, 2, b);
  stretch.SetValue(3, 3, c);
  return BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(1).Shape(), stretch, Standard_True).Shape();
}

// The intersection of two cylinders of radius r that cross at right angles: volume 16 r^3 / 3, area 16 r^2.
TopoDS_Shape steinmetz(double r) {
  const TopoDS_Shape along_z = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -3 * r), gp::DZ()), r, 6 * r).Shape();
  const TopoDS_Shape along_x = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-3 * r, 0, 0), gp::DX()), r, 6 * r).Shape();
  return BRepAlgoAPI_Common(along_z, along_x).Shape();
}

TopoDS_Shape mirrored(const TopoDS_Shape& shape) {
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp::Origin(), gp::DX()));
  return BRepBuilderAPI_Transform(shape, mirror, Standard_True).Shape();
}

}  // namespace

std::vector<ClosedForm> closed_forms() {
  const gp_Ax2 tilted(gp_Pnt(3, -2, 5), gp_Dir(1, 2, 3));
  const Vec3 axis = Vec3{1, 2, 3} / std::sqrt(14.0), at{3, -2, 5};
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), 4, 5, 6).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(3, 4.5, 6), 1.5).Shape();
  const double slant = std::hypot(2, 4);
  // An ellipsoid of half axes a = a < c has the area 2 pi a^2 (1 + c / (a e) asin e), e its eccentricity.
  const double e = std::sqrt(1 - 4.0 / 16);
  // A mirror plane through the origin turns a right-handed cone into one with left-handed axes.
  const Vec3 cone_centre = at + 1.0 * axis;
  return {
      {"box", box, 120, 148, {3, 4.5, 6}},
      {"sphere", BRepPrimAPI_MakeSphere(tilted, 2).Shape(), 32 * pi / 3, 16 * pi, at},
      {"cylinder", BRepPrimAPI_MakeCylinder(tilted, 2, 5).Shape(), 20 * pi, 28 * pi, at + 2.5 * axis},
      {"cone", BRepPrimAPI_MakeCone(tilted, 2, 0, 4).Shape(), 16 * pi / 3, pi * 2 * (2 + slant), cone_centre},
      {"cone_that_widens", BRepPrimAPI_MakeCone(tilted, 0, 2, 4).Shape(), 16 * pi / 3, pi * 2 * (2 + slant),
       at + 3.0 * axis},
      {"mirrored_cone",
       mirrored(BRepPrimAPI_MakeCone(tilted, 2, 0, 4).Shape()),
       16 * pi / 3,
       pi * 2 * (2 + slant),
       {-cone_centre.x, cone_centre.y, cone_centre.z}},
      {"torus", BRepPrimAPI_MakeTorus(tilted, 5, 1).Shape(), 10 * pi * pi, 20 * pi * pi, at},
      {"ellipsoid", ellipsoid(2, 2, 4), 4 * pi / 3 * 16, 2 * pi * 4 * (1 + 4 / (2 * e) * std::asin(e)), {}, 1e-8},
      {"box_with_spherical_void", BRepAlgoAPI_Cut(box, ball).Shape(), 120 - 4.5 * pi, 148 + 9 * pi, {3, 4.5, 6}},
      {"steinmetz", steinmetz(1.5), 16 * 1.5 * 1.5 * 1.5 / 3, 16 * 1.5 * 1.5, {}, 1e-7},
  };
}

namespace {

// The parallelogram of lattice vectors i and j at the cell's origin; outward along +k or -k.
FaceTemplate voxel_face(const Mat3& lattice, std::uint32_t k, bool outward_minus) {
  const std::uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
  const Vec3 a = lattice.column(i), b = lattice.column(j), n = cross(a, b);
  const double area = norm(n), sign = outward_minus ? -1 : 1;
  Index3 step_i{}, step_j{};
  step_i[i] = 1;
  step_j[j] = 1;
  FaceTemplate face{.surface = Plane{{.origin = {}, .z = n / area, .x = a / norm(a)}}, .reversed = outward_minus};
  face.loops = {{{i, {}, false}, {j, step_i, false}, {i, step_j, true}, {j, {}, true}}};
  face.mesh.points = {{{}, {}}, {{}, step_i}, {{}, step_i + step_j}, {{}, step_j}};
  face.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  if (outward_minus) {
    face.loops = {{{j, {}, false}, {i, step_j, false}, {j, step_i, true}, {i, {}, true}}};
    face.mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  }
  face.moments.area = area;
  face.moments.vector_area = sign * n;
  for (std::size_t c = 0; c < 3; ++c) {  // p = s a + t b over the unit square
    face.moments.volume_moment[c] = (a[c] + b[c]) / 2 * sign * n[c];
    face.moments.centroid_moment[c] = (a[c] * a[c] / 3 + b[c] * b[c] / 3 + a[c] * b[c] / 2) / 2 * sign * n[c];
  }
  for (const Vec3 corner : {Vec3{}, a, b, a + b}) face.box.extend(corner);
  return face;
}

}  // namespace

Template voxel_template(const Mat3& lattice) {
  Template t{.lattice = lattice, .vertices = {{}}, .edges = {}, .faces = {}};
  for (std::uint32_t k = 0; k < 3; ++k) {
    EdgeTemplate edge{.curve = Line{{}, lattice.column(k) / norm(lattice.column(k))}};
    edge.vertex_offset[1][k] = 1;
    t.edges.push_back(edge);
    t.faces.push_back(voxel_face(lattice, k, true));
    t.faces.push_back(voxel_face(lattice, k, false));
  }
  return t;
}

Voxels voxels(const Mat3& lattice, Index3 size, const std::function<bool(Index3)>& solid) {
  const auto is_solid = [=](Index3 c) {
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] < 0 || c[k] >= size[k]) return false;
    return solid(c);
  };
  std::vector<FaceInstance> faces;
  Voxels result;
  for (Index3 c{}; c[2] < size[2]; ++c[2])
    for (c[1] = 0; c[1] < size[1]; ++c[1])
      for (c[0] = 0; c[0] < size[0]; ++c[0]) {
        if (!is_solid(c)) continue;
        ++result.count;
        for (std::uint32_t k = 0; k < 3; ++k) {
          Index3 step{};
          step[k] = 1;
          if (!is_solid(c + Index3{-step[0], -step[1], -step[2]})) faces.push_back({2 * k, c});
          if (!is_solid(c + step)) faces.push_back({2 * k + 1, c + step});
        }
      }
  Shell shell{std::make_shared<const Template>(voxel_template(lattice)), {}, {}};
  shell.visit = [faces = std::move(faces)](const auto& callback) {
    for (const FaceInstance& face : faces) callback(face);
  };
  result.body.solids.push_back({shell, {}});
  return result;
}

}  // namespace meso::brep
