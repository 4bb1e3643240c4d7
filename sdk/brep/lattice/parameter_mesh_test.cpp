// SPDX-License-Identifier: Apache-2.0
// Crescents on all kinds of surfaces, narrower than the chords of their edges are off.
#include "lattice/parameter_mesh.hpp"

#include <gtest/gtest.h>

#include <ShapeAnalysis_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lattice/template_mesh.hpp"
#include "meso/brep/placement.hpp"
#include "test_crescents.hpp"
#include "unrolled_mesh.hpp"

namespace meso::brep {
namespace {

constexpr MeshFineness coarse{.deflection = 0.1, .angle = 0.5};

/// One face as the only one of a cell of 10 mm, and its triangles.
struct Meshed {
  explicit Meshed(const TopoDS_Face& face) {
    BRep_Builder().MakeShell(shell);
    BRep_Builder().Add(shell, face);
    TopExp::MapShapes(shell, TopAbs_EDGE, edges);
    geometry.lattice = Mat3::from_columns({10, 0, 0}, {0, 10, 0}, {0, 0, 10});
    std::vector<std::vector<Vec3>> samples;
    matches = OrbitMatcher(geometry, samples, {-5, -5, -5}, 1e-5).match(edges);
    const TemplateEdges kind{shell, edges, matches};
    polygons = mesh_alike({kind}, geometry, coarse, {});
    mesh = named_mesh(face, kind, geometry, polygons, coarse);
  }
  [[nodiscard]] std::size_t border() const {
    std::size_t points = 0;
    for (const auto& polygon : polygons) points += polygon.size() + 1;
    return points;
  }

  TopoDS_Shell shell;
  TopTools_IndexedMapOfShape edges;
  Template geometry;
  std::vector<OrbitMatcher::Match> matches;
  EdgePolygons polygons;
  std::optional<Triangulation> mesh;
};

/// Sides with one triangle only.
std::size_t open_sides(const Triangulation& mesh) {
  std::map<std::pair<PointName, PointName>, int> sides;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const PointName a = name_of(mesh.points[t[k]]), b = name_of(mesh.points[t[(k + 1) % 3]]);
      EXPECT_NE(a, b);
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return static_cast<std::size_t>(std::ranges::count_if(sides, [](const auto& side) { return side.second != 0; }));
}

/// How high a triangle is that lies the wrong way about, seen along the face's normal at its middle.
double fold(const Triangulation& mesh, const std::array<std::uint32_t, 3>& t, const TopoDS_Face& face,
            const Template& geometry) {
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.points[t[k]].point + cell_origin(geometry, mesh.points[t[k]].offset);
  ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
  const gp_Pnt2d at = surface.ValueOfUV(to_pnt((p[0] + p[1] + p[2]) / 3.0), 1e-9);
  gp_Pnt foot;
  gp_Vec u, v;
  surface.Surface()->D1(at.X(), at.Y(), foot, u, v);
  Vec3 normal = to_vec(u.Crossed(v).Normalized().XYZ());
  if (face.Orientation() == TopAbs_REVERSED) normal = -normal;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = p[(k + 1) % 3] - p[k];
    longest = std::max(longest, norm(side - dot(side, normal) * normal));
  }
  return -dot(normal, cross(p[1] - p[0], p[2] - p[0])) / longest;
}

class Crescent : public testing::TestWithParam<CrescentOn> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, Crescent, testing::ValuesIn(crescents()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Crescent, HasThePointsOfItsEdgesAndNoFold) {
  const CrescentOn& c = GetParam();
  for (const double width : {0.1, 0.016, 1e-3, 2e-5})
    for (const bool is_reversed : {false, true}) {
      TopoDS_Face face = crescent(c, width);
      if (is_reversed) face.Reverse();
      const Meshed made(face);
      ASSERT_TRUE(made.mesh) << width;
      EXPECT_EQ(open_sides(*made.mesh), made.border()) << width;
      EXPECT_LE(made.border(), 60u) << width << ": edges that are divided and divided again";
      for (const auto& t : made.mesh->triangles)
        EXPECT_LT(fold(*made.mesh, t, face, made.geometry), 1e-3 * coarse.deflection)
            << width << (is_reversed ? " reversed" : "");
    }
}

TEST(ParametersOn, RiseWherePointsAreInTheWrongOrder) {
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0));
  EXPECT_EQ(parameters_on(edge, {{0.25, 0, 0}, {0.5, 1e-4, 0}}), (std::vector<double>{0.25, 0.5}));
  const std::vector<double> turned = parameters_on(edge, {{0.5, 0, 0}, {0.4, 0, 0}, {0.6, 0, 0}});
  ASSERT_EQ(turned.size(), 3u);
  EXPECT_TRUE(0 < turned[0] && turned[0] < turned[1] && turned[1] < turned[2] && turned[2] < 1);
}

/// A bow tie of that many points on the plane z = 0, whose lobes go round in opposite directions.
BorderLoop bow_tie(int points) {
  BorderLoop loop;
  for (int i = 0; i < points; ++i) {
    const double t = 2 * std::numbers::pi * i / points;
    const Vec3 p{std::cos(t), std::sin(2 * t), 0};
    loop.push_back({p, {p.x, p.y}});
  }
  return loop;
}

TEST(UnrolledMesh, PointsWithoutAPlaceHaveNoTriangles) {
  const Handle(Geom_Plane) plane = new Geom_Plane(gp::XOY());
  EXPECT_TRUE(unrolled_mesh(plane, {bow_tie(40)}));
  BorderLoop loop = bow_tie(40);
  loop[7].at[0] = std::nan("");
  EXPECT_FALSE(unrolled_mesh(plane, {loop}));
}

}  // namespace
}  // namespace meso::brep
