// SPDX-License-Identifier: Apache-2.0
#include "ellipsoid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "face_moments.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

Affine scaled(double a, double b, double c) {
  return {Mat3::from_columns({a, 0, 0}, {0, b, 0}, {0, 0, c}), {1, -2, 3}};
}

/// Neither diagonal nor symmetric.
const Affine sheared{Mat3::from_columns({3, 0.4, 0}, {-0.7, 2, 0.9}, {0.2, 0.1, 1.2}), {10, 20, -5}};

TopoDS_Face only_face(const TopoDS_Shape& solid) { return TopoDS::Face(TopExp_Explorer(solid, TopAbs_FACE).Current()); }

TEST(Ellipsoid, IsKnownAgainByItsPoles) {
  for (const double mirror : {1.0, -1.0}) {
    Affine map = sheared;
    map.linear(0, 0) *= mirror;
    map.linear(1, 0) *= mirror;
    map.linear(2, 0) *= mirror;
    const TopoDS_Shape solid = ellipsoid_solid(map);
    EXPECT_TRUE(BRepCheck_Analyzer(solid).IsValid());
    const auto known = ellipsoid_of(only_face(solid));
    ASSERT_TRUE(known);
    EXPECT_TRUE(known->outward);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(known->map.linear.m[i], map.linear.m[i], 1e-12);
    EXPECT_FALSE(ellipsoid_of(only_face(solid.Reversed()))->outward);
  }
}

TEST(Ellipsoid, OtherFacesAreNone) {
  EXPECT_FALSE(ellipsoid_of(only_face(BRepPrimAPI_MakeBox(1, 1, 1).Solid())));
  EXPECT_FALSE(ellipsoid_of(only_face(BRepPrimAPI_MakeSphere(1, pi / 3).Solid())));  // a slice
  EXPECT_TRUE(ellipsoid_of(only_face(BRepPrimAPI_MakeSphere(2).Solid())));
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-9, -9, 0), gp_Pnt(40, 40, 9)).Solid();
  const TopoDS_Shape half = BRepAlgoAPI_Common(ellipsoid_solid(scaled(3, 2, 4)), box).Shape();
  for (TopExp_Explorer it(half, TopAbs_FACE); it.More(); it.Next())
    EXPECT_FALSE(ellipsoid_of(TopoDS::Face(it.Current())));
}

/// |det L| |L^-T n| over the unit sphere: Simpson's rule from pole to pole, which is exact to 1e-10 with these steps.
double area_by_quadrature(const Mat3& m) {
  const Mat3 cofactors = Mat3::from_columns(cross(m.column(1), m.column(2)), cross(m.column(2), m.column(0)),
                                            cross(m.column(0), m.column(1)));
  constexpr int rings = 400, sides = 200;
  double area = 0;
  for (int i = 0; i <= rings; ++i) {
    const double v = pi * i / rings - pi / 2, weight = i == 0 || i == rings ? 1 : i % 2 == 1 ? 4 : 2;
    for (int k = 0; k < sides; ++k) {
      const double u = 2 * pi * k / sides;
      area += weight * std::cos(v) *
              norm(cofactors * Vec3{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
    }
  }
  return area * (pi / rings / 3) * (2 * pi / sides);
}

TEST(Ellipsoid, MeasuresLikeQuadratureAndKernel) {
  for (const Affine& map : {sheared, scaled(4, 3, 2), scaled(1, 1, 5), scaled(5, 5, 1), scaled(2, 2, 2.000001)}) {
    const TopoDS_Shape solid = ellipsoid_solid(map);
    const FaceMoments moments = moments_of(*ellipsoid_of(only_face(solid)));
    EXPECT_NEAR(moments.area / area_by_quadrature(map.linear), 1, 1e-8);
    GProp_GProps volume, area;  // the kernel's own quadrature is good to seven digits
    BRepGProp::VolumeProperties(solid, volume, 1e-10);
    BRepGProp::SurfaceProperties(solid, area, 1e-10);
    EXPECT_NEAR(moments.area / area.Mass(), 1, 1e-6);
    EXPECT_NEAR(moments.volume_moment.x / volume.Mass(), 1, 1e-7);
    EXPECT_NEAR(norm(moments.centroid_moment / moments.volume_moment.x - to_vec(volume.CentreOfMass())), 0, 1e-6);
  }
}

TEST(Ellipsoid, AreaOfSpheroids) {
  const double e = std::sqrt(1 - 1 / 25.0);  // half axes 5 and 1
  EXPECT_NEAR(moments_of({scaled(1, 5, 1)}).area, 2 * pi * (1 + 5 / e * std::asin(e)), 1e-12);
  EXPECT_NEAR(moments_of({scaled(5, 1, 5)}).area, 2 * pi * 25 * (1 + (1 - e * e) / e * std::atanh(e)), 1e-11);
}

TEST(Ellipsoid, BoxTouches) {
  const Box3 box = box_of(Ellipsoid{sheared});
  Box3 seen;
  for (int i = 0; i <= 400; ++i)
    for (int k = 0; k < 800; ++k) {
      const double v = pi * (i / 400.0 - 0.5), u = pi * k / 400;
      seen.extend(sheared * Vec3{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
    }
  EXPECT_LT(norm(box.min - seen.min), 1e-3);
  EXPECT_LT(norm(box.max - seen.max), 1e-3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(box.min[i], seen.min[i]);
    EXPECT_GE(box.max[i], seen.max[i]);
  }
}

TEST(Ellipsoid, MeshKeepsItsToleranceAndIsClosed) {
  for (const double deflection : {0.5, 0.1, 0.01}) {
    const Ellipsoid ellipsoid{scaled(4, 3, 2)};
    const Triangulation mesh = mesh_of(ellipsoid, deflection, pi);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    double volume = 0, farthest = 0;
    for (const auto& t : mesh.triangles) {
      std::array<Vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = mesh.points[t[k]].point - ellipsoid.map.translation;
        ++uses[{t[k], t[(k + 1) % 3]}];
      }
      volume += dot(p[0], cross(p[1], p[2])) / 6;
      // The gap measured along the normal of the nearest point is no more than that along the ray from the centre.
      const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
      const double inside = norm(Vec3{middle.x / 4, middle.y / 3, middle.z / 2});
      farthest = std::max(farthest, norm(middle) * (1 / inside - 1));
    }
    for (const auto& [side, count] : uses) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(uses.count({side.second, side.first}), 1u);
    }
    EXPECT_LE(farthest, deflection);
    EXPECT_LT(volume, 32 * pi);
    EXPECT_GT(volume, 32 * pi - deflection * moments_of(ellipsoid).area);
  }
}

}  // namespace
}  // namespace meso::brep
