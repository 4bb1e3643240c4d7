// SPDX-License-Identifier: Apache-2.0
// Lattices cut by curved, tilted and many-faced bodies, against counting points by formulas that know nothing of faces.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <functional>
#include <numbers>
#include <random>

#include "boolean.hpp"
#include "lattice/clipped_lattice.hpp"
#include "lattice/primitive_field.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 centre{8.1, 7.7, 8.2};

LatticeCell bcc() {
  LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Ball{{2.5, 2.5, 2.5}, 0.9}}};
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 5.0 : 0, i & 2 ? 5.0 : 0, i & 4 ? 5.0 : 0};
    cell.primitives.push_back(Ball{corner, 0.9});
    cell.primitives.push_back(Frustum{corner, {2.5, 2.5, 2.5}, 0.5, 0.5});
  }
  return cell;
}

LatticeCell octet() {
  std::vector<Vec3> nodes;
  for (int i = 0; i < 8; ++i) nodes.push_back({i & 1 ? 5.0 : 0, i & 2 ? 5.0 : 0, i & 4 ? 5.0 : 0});
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {0.0, 5.0}) {
      Vec3 middle{2.5, 2.5, 2.5};
      middle[axis] = side;
      nodes.push_back(middle);
    }
  LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {}};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    cell.primitives.push_back(Ball{nodes[i], 0.75});
    for (std::size_t k = std::max<std::size_t>(i + 1, 8); k < nodes.size(); ++k)
      if (norm(nodes[i] - nodes[k]) < 3.6) cell.primitives.push_back(Frustum{nodes[i], nodes[k], 0.3, 0.3});
  }
  return cell;
}

/// A body twice: as faces, and as what it says of a point seen from its centre.
struct TestBody {
  TopoDS_Shape solid;
  std::function<bool(Vec3)> inside;
  double reach = 0;
};

gp_Ax2 at(double below) { return {to_pnt(centre - Vec3{0, 0, below}), gp::DZ()}; }

TestBody torus() {
  return {BRepPrimAPI_MakeTorus(at(0), 3.4, 1.8).Solid(),
          [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 3.4, p.z) < 1.8; }, 5.2};
}

TestBody cone() {
  return {BRepPrimAPI_MakeCone(at(3), 4, 1, 6).Solid(),
          [](Vec3 p) { return std::fabs(p.z) < 3 && std::hypot(p.x, p.y) < 4 - (p.z + 3) / 2; }, 5};
}

TestBody rounded_cylinder() {
  const TopoDS_Shape sharp = BRepPrimAPI_MakeCylinder(at(3.5), 3.6, 7).Solid();
  BRepFilletAPI_MakeFillet fillet(sharp);
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(sharp, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i)
    if (BRepAdaptor_Curve(TopoDS::Edge(edges(i))).GetType() == GeomAbs_Circle) fillet.Add(1, TopoDS::Edge(edges(i)));
  return {solids_of(fillet.Shape()).at(0),
          [](Vec3 p) {
            const double r = std::fmax(0, std::hypot(p.x, p.y) - 2.6), z = std::fmax(0, std::fabs(p.z) - 2.5);
            return std::hypot(r, z) < 1;
          },
          5.1};
}

/// 520 teeth on a wave: 1 042 faces.
TestBody gear() {
  constexpr int teeth = 520;
  const auto corner = [](int i) {
    const double radius = (i % 2 ? 4.2 : 4.1) + 0.3 * std::cos(10 * pi * i / teeth), angle = pi * i / teeth;
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), 0};
  };
  BRepBuilderAPI_MakePolygon outline;
  for (int i = 0; i < 2 * teeth; ++i) outline.Add(to_pnt(centre + corner(i) - Vec3{0, 0, 2}));
  outline.Close();
  const TopoDS_Shape solid =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(0, 0, 4)).Shape();
  const auto inside = [corner](Vec3 p) {
    if (std::fabs(p.z) > 2) return false;
    const int i = static_cast<int>(std::floor((std::atan2(p.y, p.x) + 2 * pi) * teeth / pi)) % (2 * teeth);
    const Vec3 a = corner(i), b = corner(i + 1);
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
  };
  return {solid, inside, 5.1};
}

/// 17 degrees about (1, 2, 0.5) through the centre.
TestBody tilted(const TestBody& body) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(to_pnt(centre), gp_Dir(1, 2, 0.5)), 17 * pi / 180);
  const gp_Trsf back = turn.Inverted();
  return {
      BRepBuilderAPI_Transform(body.solid, turn, true).Shape(),
      [back, inside = body.inside](Vec3 p) { return inside(to_vec(to_pnt(p + centre).Transformed(back)) - centre); },
      body.reach};
}

/// The volume in `made` is that of the lattice in the body, and its faces close.
void expect_right(const LatticeCell& lattice, const TestBody& body) {
  DiagnosticSink sink;
  const auto cell = cell_shape(lattice, sink);
  const auto made = clipped_lattice_body(*cell, {3, 3, 3}, {body.solid}, {}, {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  ASSERT_TRUE(made);
  EXPECT_TRUE(audit(made->body).clean());
  EXPECT_GE(made->distinct, 8u);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-body.reach, body.reach);
  constexpr int count = 200'000;
  int hits = 0;
  for (int n = 0; n < count; ++n) {
    const Vec3 from_centre{uniform(random), uniform(random), uniform(random)};
    if (!body.inside(from_centre)) continue;
    Vec3 p = centre + from_centre;
    for (std::size_t i = 0; i < 3; ++i) p[i] -= 5 * std::floor(p[i] / 5);
    hits += signed_distance(lattice.primitives, p) < 0;
  }
  const double share = static_cast<double>(hits) / count, all = std::pow(2 * body.reach, 3);
  EXPECT_NEAR(measure(made->body).volume, share * all, 3 * std::sqrt(share * (1 - share) / count) * all);
}

TEST(CurvedBodies, Torus) { expect_right(bcc(), tilted(torus())); }
TEST(CurvedBodies, Cone) { expect_right(bcc(), tilted(cone())); }
TEST(CurvedBodies, RoundedCylinder) { expect_right(bcc(), rounded_cylinder()); }
TEST(CurvedBodies, AThousandFaces) { expect_right(bcc(), tilted(gear())); }
TEST(CurvedBodies, OctetInACone) { expect_right(octet(), tilted(cone())); }

}  // namespace
}  // namespace meso::brep
