// SPDX-License-Identifier: Apache-2.0
// Lattices cut by curved, tilted and many-faced bodies, against counting points by formulas that know nothing of faces.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>

#include "boolean.hpp"
#include "lattice/cell_clipper.hpp"
#include "lattice/clipped_lattice.hpp"
#include "lattice/primitive_field.hpp"
#include "lattice/test_cells.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 centre{8.1, 7.7, 8.2};

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

/// A round body whose radius is a cubic polynomial of the height, as rational B-spline surfaces.
TestBody spline_vase() {
  constexpr std::array<double, 4> radii{2.8, 5.6, 0.8, 3.6};
  TColgp_Array1OfPnt poles(1, 4);
  for (int i = 0; i < 4; ++i)
    poles(i + 1) = to_pnt(centre + Vec3{radii[static_cast<std::size_t>(i)], 0, -4 + 8.0 * i / 3});
  const TopoDS_Edge side = BRepBuilderAPI_MakeEdge(new Geom_BezierCurve(poles)).Edge();
  const gp_Pnt low = to_pnt(centre - Vec3{0, 0, 4}), high = to_pnt(centre + Vec3{0, 0, 4});
  BRepBuilderAPI_MakeWire outline(side, BRepBuilderAPI_MakeEdge(poles(4), high).Edge(),
                                  BRepBuilderAPI_MakeEdge(high, low).Edge());
  outline.Add(BRepBuilderAPI_MakeEdge(low, poles(1)).Edge());
  const TopoDS_Shape turned =
      BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Ax1(low, gp::DZ())).Shape();
  const auto inside = [radii](Vec3 p) {
    const double t = (p.z + 4) / 8, s = 1 - t;
    const double radius =
        radii[0] * s * s * s + 3 * radii[1] * s * s * t + 3 * radii[2] * s * t * t + radii[3] * t * t * t;
    return std::fabs(p.z) < 4 && std::hypot(p.x, p.y) < radius;
  };
  return {solids_of(BRepBuilderAPI_NurbsConvert(turned, true).Shape()).at(0), inside, 5};
}

/// A cube that a polynomial map bends: six faces, each one a B-spline surface, four of them curved.
TestBody bent_cube() {
  const auto bend = [](Vec3 p) {
    return Vec3{4 * p.x + 1.2 * p.z * p.z, 3.6 * p.y * (1 + 0.25 * p.z) + p.x * p.x, 3.6 * p.z};
  };
  BRepBuilderAPI_Sewing sewing(1e-7);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      // Biquadratic: the values at -1, 0 and 1 say all.
      std::array<std::array<Vec3, 3>, 3> poles;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = static_cast<double>(i) - 1;
          p[(axis + 2) % 3] = static_cast<double>(k) - 1;
          poles[i][k] = bend(p);
        }
      for (std::size_t k = 0; k < 3; ++k) poles[1][k] = 2.0 * poles[1][k] - 0.5 * (poles[0][k] + poles[2][k]);
      for (auto& row : poles) row[1] = 2.0 * row[1] - 0.5 * (row[0] + row[2]);
      TColgp_Array2OfPnt points(1, 3, 1, 3);
      for (int i = 1; i <= 3; ++i)
        for (int k = 1; k <= 3; ++k)
          points(i, k) = to_pnt(centre + poles[static_cast<std::size_t>(i) - 1][static_cast<std::size_t>(k) - 1]);
      const Handle(Geom_Surface) surface = GeomConvert::SurfaceToBSplineSurface(new Geom_BezierSurface(points));
      sewing.Add(BRepBuilderAPI_MakeFace(surface, 1e-7).Face());
    }
  sewing.Perform();
  const TopExp_Explorer shell(sewing.SewedShape(), TopAbs_SHELL);
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(shell.Current())).Solid();
  BRepLib::OrientClosedSolid(solid);
  const auto inside = [](Vec3 p) {
    const double z = p.z / 3.6, x = (p.x - 1.2 * z * z) / 4, y = (p.y - x * x) / (3.6 * (1 + 0.25 * z));
    return std::fabs(x) < 1 && std::fabs(y) < 1 && std::fabs(z) < 1;
  };
  return {solids_of(solid).at(0), inside, 5.6};
}

/// What other programs would read of it.
TestBody through_step(const TestBody& body) {
  const std::string file = (std::filesystem::temp_directory_path() / "meso_curved_body.step").string();
  STEPControl_Writer writer;
  writer.Transfer(body.solid, STEPControl_AsIs);
  writer.Write(file.c_str());
  STEPControl_Reader reader;
  reader.ReadFile(file.c_str());
  reader.TransferRoots();
  std::filesystem::remove(file);
  return {solids_of(reader.OneShape()).at(0), body.inside, body.reach};
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
  EXPECT_GE(made->clip.distinct, 8u);
  EXPECT_LT(made->clip.edge_tolerance, rough_edge * lattice.box.max.x);
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
TEST(CurvedBodies, ImportedVaseOfBSplines) { expect_right(bcc(), tilted(through_step(spline_vase()))); }
TEST(CurvedBodies, ImportedBentCube) { expect_right(bcc(), through_step(bent_cube())); }
TEST(CurvedBodies, OctetInACone) { expect_right(octet(), tilted(cone())); }

}  // namespace
}  // namespace meso::brep
