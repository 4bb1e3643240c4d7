// SPDX-License-Identifier: Apache-2.0
// Every primitive, volume element and boolean against its closed form.
#include "solid_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "boolean.hpp"

namespace meso::brep {
namespace {

using namespace eval;
using std::numbers::pi;

double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-10);
  return properties.Mass();
}

class SolidFromShape : public ::testing::Test {
 protected:
  std::optional<Solids> solids(const Shape& shape, const Affine& map = {}) {
    return solid_from_shape(shape, map, {source_, run_, sink_});
  }
  /// Volume of a valid, closed result; NaN where there is none.
  double volume(const Shape& shape, const Affine& map = {}) {
    const auto made = solids(shape, map);
    if (!made) return std::nan("");
    double sum = 0;
    for (const TopoDS_Shape& solid : *made) {
      EXPECT_TRUE(BRepCheck_Analyzer(solid).IsValid());
      EXPECT_EQ(edge_uses(solid).free, 0u);
      EXPECT_EQ(edge_uses(solid).multiple, 0u);
      sum += volume_of(solid);
    }
    return sum;
  }
  double area(const Shape& shape) {
    double sum = 0;
    if (const auto made = solids(shape))
      for (const TopoDS_Shape& solid : *made) sum += area_of(solid);
    return sum;
  }
  void expect_code(Code code) {
    ASSERT_FALSE(sink_.diagnostics().empty());
    EXPECT_EQ(sink_.diagnostics().front().code, code) << render(sink_.diagnostics().front());
  }

  SourceMap source_;
  RunOptions run_;
  DiagnosticSink sink_;
};

void expect_relative(double value, double truth) { EXPECT_NEAR(value / truth, 1, 1e-6) << value << " vs " << truth; }

std::shared_ptr<const CoordinateFrame> system(std::vector<CoordinateAxis> axes, const Affine& placement = {}) {
  return std::make_shared<CoordinateFrame>(placement, std::move(axes));
}
const CoordinateAxis distance_x{"r", AxisKind::distance, {1, 0, 0}};
const CoordinateAxis circular_z{"phi", AxisKind::circular, {0, 0, 1}};
const CoordinateAxis circular_minus_y{"elevation", AxisKind::circular, {0, -1, 0}};
const CoordinateAxis linear_z{"z", AxisKind::linear, {0, 0, 1}};

TEST_F(SolidFromShape, Primitives) {
  expect_relative(volume({BoxShape{{1, 2, 3}, {2, 3, 4}}}), 24);
  expect_relative(volume({SphereShape{{1, 2, 3}, 2}}), 4.0 / 3 * pi * 8);
  expect_relative(area({SphereShape{{1, 2, 3}, 2}}), 4 * pi * 4);
  expect_relative(volume({EllipsoidShape{{1, 2, 3}, {1, 2, 3}}}), 4.0 / 3 * pi * 6);
  expect_relative(volume({EllipsoidShape{{1, 2, 3}, {2, 2, 3}}}), 4.0 / 3 * pi * 12);
  expect_relative(volume({CylinderShape{{1, 2, 3}, {2, 4, 5}, 0.5}}), pi * 0.25 * 3);
  expect_relative(volume({ConeShape{{0, 0, 0}, {0, 3, 0}, 2, 1}}), pi * 3 / 3 * (4 + 2 + 1));
  expect_relative(volume({ConeShape{{0, 0, 0}, {0, 3, 0}, 2, 0}}), pi * 4);
  expect_relative(volume({ConeShape{{0, 0, 0}, {0, 3, 0}, 0, 2}}), pi * 4);
  expect_relative(volume({TorusShape{{1, 0, 0}, {0, 1, 1}, 3, 1}}), 2 * pi * pi * 3);
  expect_relative(area({TorusShape{{1, 0, 0}, {0, 1, 1}, 3, 1}}), 4 * pi * pi * 3);
  EXPECT_TRUE(sink_.diagnostics().empty());
}

TEST_F(SolidFromShape, ExtrusionOfEitherSense) {
  ExtrusionShape l{.z = 1, .height = 2, .points = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}};
  expect_relative(volume({l}), 10);
  std::ranges::reverse(l.points);
  expect_relative(volume({l}), 10);
}

TEST_F(SolidFromShape, RevolutionOfEitherSense) {
  RevolutionShape ring{
      {{1, -1}, {4, -1}, {4, 1}, {2, 1}, {2, 3}, {1, 3}}};  // Pappus: 2 pi times each rectangle's moment
  expect_relative(volume({ring}), 2 * pi * (15 + 3));
  expect_relative(area({ring}), 2 * pi * (15 / 2.0 + 4 * 2 + 6 + 2 * 2 + 3 / 2.0 + 4));
  std::reverse(ring.points.begin(), ring.points.end());
  expect_relative(volume({ring}), 2 * pi * (15 + 3));
  // A cone on a cylinder: the side on the axis makes no face.
  const RevolutionShape pencil{{{0, 0}, {2, 0}, {2, 5}, {0, 8}}};
  expect_relative(volume({pencil}), pi * 4 * 5 + pi * 4);
  std::size_t faces = 0;
  for (TopExp_Explorer f(solids({pencil})->front(), TopAbs_FACE); f.More(); f.Next()) ++faces;
  EXPECT_EQ(faces, 3u);
  // A spindle that meets the axis in two points, stretched to an elliptic one.
  const Affine stretched{Mat3::from_columns({2, 0, 0}, {0, 1, 0}, {0, 0, 1}), {5, 5, 5}};
  expect_relative(volume({RevolutionShape{{{0, -3}, {2, 0}, {0, 3}}}}), pi * 4 * 2);
  expect_relative(volume({RevolutionShape{{{0, -3}, {2, 0}, {0, 3}}}}, stretched), 2 * pi * 4 * 2);
}

TEST_F(SolidFromShape, RevolutionTooCloseToItsAxisIsRefused) {
  EXPECT_FALSE(solids({RevolutionShape{{{1e-7, 0}, {2, 0}, {0, 3}}}}));
  expect_code(Code::geometry_size);
}

Polyhedron block(Vec3 corner, Vec3 size) {
  Polyhedron p;
  for (const double z : {0.0, size.z})
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {size.x, 0.0}, {size.x, size.y}, {0.0, size.y}})
      p.vertices.push_back(corner + Vec3{x, y, z});
  p.faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return p;
}

TEST_F(SolidFromShape, PolyhedronWithACavityAndABodyInIt) {
  Polyhedron p = block({0, 0, 0}, {6, 6, 6});
  const auto add = [&](Polyhedron other, bool turned) {
    for (auto& face : other.faces) {
      for (std::size_t& v : face) v += p.vertices.size();
      if (turned) std::reverse(face.begin(), face.end());
      p.faces.push_back(face);
    }
    p.vertices.insert(p.vertices.end(), other.vertices.begin(), other.vertices.end());
  };
  add(block({1, 1, 1}, {4, 4, 4}), true);
  add(block({2, 2, 2}, {1, 2, 1}), false);
  ASSERT_FALSE(polyhedron_fault(p));
  expect_relative(volume({PolyhedronShape{p}}), 216 - 64 + 2);
  EXPECT_EQ(solids({PolyhedronShape{p}})->size(), 2u);
  const Affine mirrored{Mat3::from_columns({-1, 0, 0}, {0.5, 2, 0}, {0, 0, 1}), {1, 2, 3}};
  expect_relative(volume({PolyhedronShape{p}}, mirrored), 2 * (216 - 64 + 2));
}

TEST_F(SolidFromShape, PolyhedronWithFacesThatAreNearlyPlane) {
  Polyhedron p = block({0, 0, 0}, {3, 3, 3});
  p.vertices[6].z += 3e-6;
  ASSERT_FALSE(polyhedron_fault(p));
  expect_relative(volume({PolyhedronShape{p}}), 27);
}

TEST_F(SolidFromShape, ExtrusionThatCrossesItselfIsRefused) {
  EXPECT_FALSE(solids({ExtrusionShape{.height = 1, .points = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}}}));
  expect_code(Code::geometry_profile);
}

TEST_F(SolidFromShape, SizesThatAreNone) {
  const double nan = std::nan("");
  for (const Shape& shape :
       {Shape{SphereShape{{}, nan}}, Shape{SphereShape{{}, 0}}, Shape{SphereShape{{nan, 0, 0}, 1}},
        Shape{BoxShape{{}, {1, 1, HUGE_VAL}}}, Shape{CylinderShape{{}, {}, 1}}, Shape{SphereShape{{}, -1}},
        Shape{TorusShape{{}, {0, 0, 1}, 1, 2}}, Shape{ConeShape{{}, {0, 0, 1}, 0, 0}}}) {
    sink_ = DiagnosticSink();
    EXPECT_FALSE(solids(shape));
    expect_code(Code::geometry_size);
  }
}

TEST_F(SolidFromShape, MapsKeepOrTurnOrStretch) {
  const Affine mirrored{Mat3::from_columns({-2, 0, 0}, {0, 2, 0}, {0, 0, 2}), {5, 0, 0}};
  const Affine sheared{Mat3::from_columns({1, 0, 0}, {0.5, 2, 0}, {0, 0.25, 3}), {1, 2, 3}};
  const Affine turned{rotation({0, 0, 1}, 0.3), {1, 2, 3}};
  const Shape cone{ConeShape{{0, 0, 0}, {0, 3, 0}, 2, 1}};
  for (const Affine& map : {mirrored, sheared, turned}) {
    const double factor = std::fabs(determinant(map.linear));
    expect_relative(volume(cone, map), 7 * pi * factor);
    expect_relative(volume({BoxShape{{1, 2, 3}, {2, 3, 4}}}, map), 24 * factor);
  }
}

TEST_F(SolidFromShape, PolarSectors) {
  const auto polar = system({distance_x, circular_z, linear_z});
  const auto sector = [&](double r0, double r1, double a0, double a1) {
    return Shape{VolumeElementShape{polar, {0, 1, 2}, {r0, a0, 1}, {r1, a1, 3}}};
  };
  expect_relative(volume(sector(2, 3, 0.1, 0.9)), (9 - 4) / 2.0 * 0.8 * 2);
  expect_relative(area(sector(2, 3, 0.1, 0.9)), 2 * (9 - 4) / 2.0 * 0.8 + 2 * 1 * 2 + (2 + 3) * 0.8 * 2);
  expect_relative(volume(sector(0, 3, 0.1, 0.9)), 9 / 2.0 * 0.8 * 2);
  expect_relative(volume(sector(0, 3, 0, 2 * pi)), 9 * pi * 2);
  expect_relative(volume(sector(2, 3, -1, 2 * pi - 1)), 5 * pi * 2);
  expect_relative(volume(sector(2, 3, 0, 1.5 * pi)), 5 * 0.75 * pi * 2);
  EXPECT_FALSE(solids(sector(2, 3, 0, 7)));
  expect_code(Code::geometry_volume_element);
}

TEST_F(SolidFromShape, SphericalSectors) {
  const auto spherical = system({circular_z, circular_minus_y, distance_x}, {rotation({1, 0, 0}, 0.4), {1, 2, 3}});
  const auto sector = [&](double r0, double r1, double a0, double a1, double e0, double e1) {
    return Shape{VolumeElementShape{spherical, {2, 0, 1}, {r0, a0, e0}, {r1, a1, e1}}};
  };
  const auto truth = [](double r0, double r1, double a, double e0, double e1) {
    return (r1 * r1 * r1 - r0 * r0 * r0) / 3 * a * (std::sin(e1) - std::sin(e0));
  };
  expect_relative(volume(sector(2, 3, 0.1, 0.9, -0.2, 0.5)), truth(2, 3, 0.8, -0.2, 0.5));
  expect_relative(volume(sector(0, 3, 0.1, 0.9, -0.2, 0.5)), truth(0, 3, 0.8, -0.2, 0.5));
  expect_relative(volume(sector(2, 3, 0.1, 0.9, 0.2, pi / 2)), truth(2, 3, 0.8, 0.2, pi / 2));
  expect_relative(volume(sector(2, 3, 0, 2 * pi, 0.2, pi / 2)), truth(2, 3, 2 * pi, 0.2, pi / 2));
  expect_relative(volume(sector(2, 3, 0, 2 * pi, -pi / 2, pi / 2)), 4.0 / 3 * pi * 19);
  expect_relative(volume(sector(0, 3, 0, 2 * pi, -pi / 2, pi / 2)), 4.0 / 3 * pi * 27);
  expect_relative(volume(sector(0, 3, 0, 1, -pi / 2, pi / 2)), 1 / (2 * pi) * 4.0 / 3 * pi * 27);
  EXPECT_FALSE(solids(sector(1, 2, 0, 1, 0, 2)));
  expect_code(Code::geometry_volume_element);
}

TEST_F(SolidFromShape, PolarAngleFromThePole) {
  // Angle 0 along z, turned towards x about y.
  const auto spherical =
      system({circular_z, {"theta", AxisKind::circular, {0, 1, 0}}, {"r", AxisKind::distance, {0, 0, 1}}});
  const Shape cap{VolumeElementShape{spherical, {0, 1, 2}, {0, 0, 2}, {2 * pi, 1, 3}}};
  expect_relative(volume(cap), 19.0 / 3 * 2 * pi * (1 - std::cos(1)));
  const Shape all{VolumeElementShape{spherical, {0, 1, 2}, {0, 0, 0}, {2 * pi, pi, 3}}};
  expect_relative(volume(all), 4.0 / 3 * pi * 27);
}

TEST_F(SolidFromShape, StraightElements) {
  const double s = std::sqrt(0.5);
  const auto oblique = system({{"a", AxisKind::linear, {1, 0, 0}}, {"b", AxisKind::linear, {s, s, 0}}, linear_z});
  expect_relative(volume({VolumeElementShape{oblique, {0, 1, 2}, {1, 2, 3}, {2, 4, 6}}}), 1 * 2 * 3 * s);
  const auto flat = system({{"a", AxisKind::linear, {1, 0, 0}}, {"b", AxisKind::distance, {1, 0, 0}}, linear_z});
  EXPECT_FALSE(solids({VolumeElementShape{flat, {0, 1, 2}, {1, 2, 3}, {2, 4, 6}}}));
  expect_code(Code::geometry_volume_element);
}

TEST_F(SolidFromShape, ObliqueSweepIsNotRealised) {
  const double s = std::sqrt(0.5);
  const auto oblique = system({distance_x, circular_z, {"z", AxisKind::linear, {s, 0, s}}});
  EXPECT_FALSE(solids({VolumeElementShape{oblique, {0, 1, 2}, {1, 0, 3}, {2, 1, 6}}}));
  expect_code(Code::brep_not_realised);
}

TEST_F(SolidFromShape, SteinmetzSolid) {
  const Shape both{
      BooleanShape{BooleanOperation::intersection,
                   {{CylinderShape{{-3, 0, 0}, {3, 0, 0}, 1}}, {CylinderShape{{0, -3, 0}, {0, 3, 0}, 1}}}}};
  expect_relative(volume(both), 16.0 / 3);
  const Shape either{
      BooleanShape{BooleanOperation::union_,
                   {{CylinderShape{{-3, 0, 0}, {3, 0, 0}, 1}}, {CylinderShape{{0, -3, 0}, {0, 3, 0}, 1}}}}};
  expect_relative(volume(either), 12 * pi - 16.0 / 3);
}

TEST_F(SolidFromShape, DifferenceWithOverlappingTools) {
  const Shape box{BoxShape{{0, 0, 0}, {10, 10, 10}}};
  const Shape ball{SphereShape{{5, 5, 5}, 1}}, shifted{SphereShape{{6, 5, 5}, 1}};
  // Two unit balls at distance 1 share a lens of 5 pi / 12.
  expect_relative(volume({BooleanShape{BooleanOperation::difference, {box, ball, shifted}}}),
                  1000 - (8.0 / 3 * pi - 5 * pi / 12));
}

TEST_F(SolidFromShape, DisjointAndEmptyBooleans) {
  const Shape a{BoxShape{{0, 0, 0}, {1, 1, 1}}}, b{BoxShape{{3, 0, 0}, {1, 1, 1}}};
  expect_relative(volume({BooleanShape{BooleanOperation::union_, {a, b}}}), 2);
  expect_relative(volume({BooleanShape{BooleanOperation::difference, {a, b}}}), 1);
  const auto none = solids({BooleanShape{BooleanOperation::intersection, {a, b}}});
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
  EXPECT_EQ(volume({BooleanShape{BooleanOperation::difference, {a, a}}}), 0);
}

TEST_F(SolidFromShape, BeamsOfACentredCell) {
  // Four diagonals: struts of radius r end in exact circles on balls of radius R.
  BeamsShape bcc;
  const double a = 5, r = 0.5, ball = 0.9;
  for (const double x : {0.0, a})
    for (const double y : {0.0, a})
      for (const double z : {0.0, a}) bcc.nodes.push_back({{x, y, z}, ball});
  bcc.nodes.push_back({{a / 2, a / 2, a / 2}, ball});
  for (std::size_t i = 0; i < 8; ++i) bcc.struts.push_back({i, 8, r, r, BeamCap::butt, BeamCap::butt});
  const Shape clipped{BooleanShape{BooleanOperation::intersection, {{bcc}, {BoxShape{{}, {a, a, a}}}}}};
  const double half = std::sqrt(3.0) / 2 * a, cut = std::sqrt(ball * ball - r * r);
  const double cap = pi * std::pow(ball - cut, 2) * (3 * ball - (ball - cut)) / 3;  // of the ball, beyond the circle
  const double strut = pi * r * r * (half - 2 * cut);
  expect_relative(volume(clipped), 2 * 4.0 / 3 * pi * ball * ball * ball + 8 * (strut - 2 * cap));
}

TEST_F(SolidFromShape, BeamCaps) {
  const auto beam = [](BeamCap cap, double r0, double r1) {
    return Shape{BeamsShape{{{{0, 0, 0}, 0}, {{0, 0, 4}, 0}}, {{0, 1, r0, r1, cap, cap}}}};
  };
  expect_relative(volume(beam(BeamCap::butt, 1, 1)), 4 * pi);
  expect_relative(volume(beam(BeamCap::sphere, 1, 1)), 4 * pi + 4.0 / 3 * pi);
  expect_relative(volume(beam(BeamCap::hemisphere, 1, 1)), 4 * pi + 4.0 / 3 * pi);
  expect_relative(volume(beam(BeamCap::hemisphere, 2, 1)), 4.0 / 3 * pi * 7 + 2.0 / 3 * pi * 9);
}

TEST_F(SolidFromShape, NearlyEqualRadiiAreRightOrRefused) {
  for (const double gap : {1e-5, 1e-6, 1e-7}) {
    const Shape cross{
        BooleanShape{BooleanOperation::union_,
                     {{CylinderShape{{-3, 0, 0}, {3, 0, 0}, 1}}, {CylinderShape{{0, -3, 0}, {0, 3, 0}, 1 + gap}}}}};
    if (const auto made = solids(cross)) {
      double sum = 0;
      for (const TopoDS_Shape& solid : *made) sum += volume_of(solid);
      // To first order the wider cylinder gains its lateral area outside the other, 12 pi - 8, times the gap.
      EXPECT_NEAR(sum, 12 * pi - 16.0 / 3 + (12 * pi - 8) * gap, 3e-5) << gap;
    } else {
      expect_code(Code::geometry_boolean);
    }
  }
}

TEST_F(SolidFromShape, BodiesOfOtherEngines) {
  EXPECT_FALSE(solids({ImplicitShape{}}));
  expect_code(Code::brep_not_realised);
}

}  // namespace
}  // namespace meso::brep
