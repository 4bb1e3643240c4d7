// SPDX-License-Identifier: Apache-2.0
// Parts of faces within windows: areas against closed forms, edges shared with the faces beside them.
#include "lattice/face_windows.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "boolean.hpp"
#include "face_moments.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double radius = 0.3;

/// 6 x 6 x 1 with holes of that radius around (i + 0.5, k + 0.5).
TopoDS_Shape plate() {
  TopTools_ListOfShape bodies, tools;
  bodies.Append(BRepPrimAPI_MakeBox(6, 6, 1).Solid());
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k)
      tools.Append(BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(i + 0.5, k + 0.5, -1), gp_Dir(0, 0, 1)), radius, 3).Solid());
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(bodies);
  cut.SetTools(tools);
  cut.Build();
  return solids_of(cut.Shape()).at(0);
}

/// The plate's faces with their meshes: the two with holes, then all others.
struct Faces {
  Faces() {
    const CellGrid grid{.first = {{0, 0, 0}, {1, 1, 1}}, .min = {0, 0, 0}, .max = {5, 5, 0}, .tolerance = 1e-6};
    surface.emplace(std::vector{plate()}, grid);
    std::uint32_t number = 0;
    for (TopExp_Explorer it(surface->body(), TopAbs_FACE); it.More(); it.Next(), ++number) {
      FaceEdges face{TopoDS::Face(it.Current()), {}};
      for (TopExp_Explorer edge(face.face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); edge.More(); edge.Next())
        face.edges.push_back(TopoDS::Edge(edge.Current()));
      if (face.edges.size() > 30) holed.push_back(all.size());
      all.push_back(std::move(face));
    }
  }
  /// The faces with the same window, of x and y, in those that have holes.
  [[nodiscard]] std::vector<std::vector<TopoDS_Face>> within(double x0, double y0, double x1, double y1) const {
    FaceWindows windows(1e-6);
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (std::ranges::find(holed, f) == holed.end()) {
        windows.add(all[f]);
        continue;
      }
      ParameterRange window;
      const gp_Pln plane = BRepAdaptor_Surface(all[f].face).Plane();
      for (const auto& [x, y] : {std::pair{x0, y0}, std::pair{x1, y1}}) {
        const gp_Vec from(plane.Location(), gp_Pnt(x, y, plane.Location().Z()));
        window.extend({from.Dot(gp_Vec(plane.XAxis().Direction())), from.Dot(gp_Vec(plane.YAxis().Direction()))});
      }
      windows.add(all[f], surface->face(static_cast<std::uint32_t>(f)), window);
    }
    return windows.made();
  }
  [[nodiscard]] double area(double x0, double y0, double x1, double y1) const {
    const auto made = within(x0, y0, x1, y1);
    EXPECT_EQ(made.size(), all.size());
    std::array<double, 2> areas{};
    for (std::size_t i = 0; i < 2; ++i)
      for (const TopoDS_Face& face : made[holed[i]]) {
        EXPECT_TRUE(BRepCheck_Analyzer(face).IsValid());
        areas[i] += face_moments(face).area;
      }
    EXPECT_NEAR(areas[0], areas[1], 1e-9);
    return areas[0];
  }

  std::optional<BodySurface> surface;
  std::vector<FaceEdges> all;
  std::vector<std::size_t> holed;
};

double segment(double height) {  // of a hole, beyond a line
  const double half = std::acos((radius - height) / radius);
  return radius * radius * (half - std::sin(half) * std::cos(half));
}

double corner() {  // of a hole, beyond two lines at right angles, each 0.1 from its middle
  const double along = std::sqrt(radius * radius - 0.01), angle = pi / 2 - 2 * std::asin(0.1 / radius);
  return radius * radius * angle / 2 - 0.1 * (along - 0.1);
}

TEST(FaceWindows, HaveTheAreaOfWhatIsLeft) {
  const Faces faces;
  ASSERT_EQ(faces.holed.size(), 2u);
  const double hole = pi * radius * radius;
  EXPECT_NEAR(faces.area(1, 1, 3, 2), 2 - 2 * hole, 1e-9);                       // holes within
  EXPECT_NEAR(faces.area(0.9, 0.9, 1.1, 1.1), 0.04, 1e-9);                       // no edge near
  EXPECT_NEAR(faces.area(1.5, 0.9, 2.5, 2.1), 1.2 - hole, 1e-9);                 // through the middle of two
  EXPECT_NEAR(faces.area(1, 1, 1.3, 2), 0.3 - segment(0.1), 1e-9);               // a segment of one
  EXPECT_NEAR(faces.area(0.6, 0.6, 1.4, 1.4), 0.64 - 4 * corner(), 1e-9);        // corners in four
  EXPECT_NEAR(faces.area(0.5, 0.5, 1.5, 1.5), 36 * (1 - hole), 1e-9);            // the border meets a vertex: whole
  EXPECT_NEAR(faces.area(-1, -1, 1, 1), 1 - hole, 1e-9);                         // beyond a corner of the plate
  EXPECT_NEAR(faces.area(-1, 2.5, 0.5, 7), 0.5 * 3.5 - 0.5 * 3.5 * hole, 1e-9);  // across an edge and holes
  EXPECT_NEAR(faces.area(-1, -1, 7, 7), 36 * (1 - hole), 1e-9);                  // all of it
}

TEST(FaceWindows, ShareEdgesWithTheFacesBesideThem) {
  const Faces faces;
  const auto made = faces.within(1.5, 0.9, 2.5, 2.1);
  for (const std::size_t f : faces.holed) {
    int border = 0, shared = 0;
    ASSERT_EQ(made[f].size(), 1u);
    for (TopExp_Explorer it(made[f][0], TopAbs_EDGE); it.More(); it.Next()) {
      int uses = 0;
      for (const auto& other : made)
        for (TopExp_Explorer own(other[0], TopAbs_EDGE); own.More(); own.Next())
          uses += own.Current().IsSame(it.Current());
      const bool round = BRepAdaptor_Curve(TopoDS::Edge(it.Current())).GetType() == GeomAbs_Circle;
      EXPECT_EQ(uses, round ? 2 : 1);
      ++(round ? shared : border);
    }
    EXPECT_GE(shared, 2);
    EXPECT_EQ(border, 6);
  }
  // What is divided is as it was.
  double before = 0, after = 0;
  for (std::size_t f = 0; f < made.size(); ++f) {
    if (std::ranges::find(faces.holed, f) != faces.holed.end()) continue;
    before += face_moments(faces.all[f].face).area;
    after += face_moments(made[f][0]).area;
    EXPECT_TRUE(BRepCheck_Analyzer(made[f][0]).IsValid());
  }
  EXPECT_NEAR(after, before, 1e-9);
  EXPECT_NEAR(before, 4 * 6 + 36 * 2 * pi * radius, 1e-9);
}

TEST(FaceWindows, OfAFaceThatFallsApart) {
  const Faces faces;
  // Narrower than the holes of a column.
  const auto made = faces.within(0.4, 0.6, 0.6, 3.6);
  const double half = std::sqrt(radius * radius - 0.01), cap = segment(radius - half) / 2;
  for (const std::size_t f : faces.holed) {
    ASSERT_EQ(made[f].size(), 3u);
    for (const TopoDS_Face& face : made[f]) {
      EXPECT_EQ(TopoDS_Iterator(face).Value().NbChildren(), 4);
      EXPECT_NEAR(face_moments(face).area, 0.2 * (1 - 2 * half) - 4 * cap, 1e-9);
    }
  }
}

}  // namespace
}  // namespace meso::brep
