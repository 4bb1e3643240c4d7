// SPDX-License-Identifier: Apache-2.0
// What a cell and a body have in common, and what tells that faces of the body did not divide what they should have.
#include "lattice/cell_split.hpp"

#include <gtest/gtest.h>

#include <GC_MakeArcOfCircle.hxx>
#include <random>

#include "boolean.hpp"
#include "lattice/cell_solid.hpp"
#include "lattice/primitive_field.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr double edge = 5;

/// A body as a cell sees it: the faces of `solid` that `seen` takes, and the truth about every point.
template <typename Seen>
LocalBody body_of(const TopoDS_Shape& solid, const Box3& box, const Seen& seen) {
  LocalBody body;
  std::vector<TopoDS_Face> faces;
  const WholeCell whole = whole_cell(solid, 0.01);
  for (const WholeCell::Face& face : whole.faces) {
    if (!seen(face.box)) continue;
    const std::size_t first = body.triangles.size();
    faces.push_back(face.face);
    body.triangles.insert(body.triangles.end(), face.triangles.begin(), face.triangles.end());
    body.of_face.push_back({first, body.triangles.size()});
  }
  body.faces = {compound_of(faces)};
  body.reach = 1e-3;
  body.contains = [box](Vec3 p) {
    for (std::size_t i = 0; i < 3; ++i)
      if (p[i] < box.min[i] || p[i] > box.max[i]) return false;
    return true;
  };
  body.side = [contains = body.contains](Vec3 p) { return contains(p) ? 1 : -1; };
  return body;
}

struct Slab {
  Box3 box;
  [[nodiscard]] TopoDS_Shape solid() const { return BRepPrimAPI_MakeBox(to_pnt(box.min), to_pnt(box.max)).Solid(); }
};

/// A cube from 0 to 5.
template <typename Seen>
ClippedCell split(const Slab& slab, const Seen& seen) {
  WholeCell cell = whole_cell(BRepPrimAPI_MakeBox(edge, edge, edge).Solid(), 0.01);
  return split_cell(cell, body_of(slab.solid(), slab.box, seen), {.size = edge}, {});
}
bool every_face(const Box3&) { return true; }

const Slab across{{{1, -9, -9}, {3, 9, 9}}};

TEST(CellSplit, WhatIsInBothIsLeft) {
  const ClippedCell part = split(across, every_face);
  ASSERT_EQ(part.left, ClippedCell::Left::part) << part.fault;
  EXPECT_NEAR(volume_of(part.solid), 2 * edge * edge, 1e-9);
  EXPECT_EQ(edge_uses(part.solid).free, 0u);
  EXPECT_EQ(split(Slab{{{-1, -9, -9}, {9, 9, 9}}}, every_face).left, ClippedCell::Left::all);
  const ClippedCell nothing = split(Slab{{{6, -9, -9}, {9, 9, 9}}}, every_face);
  EXPECT_EQ(nothing.left, ClippedCell::Left::nothing);
  EXPECT_EQ(nothing.fault, "");
}

TEST(CellSplit, AFaceThatDividedNothingIsFoundByOtherPoints) {
  // Without the slab's face at x = 1 the piece up to x = 3 is partly inside; each of its sums is right.
  const ClippedCell wrong = split(across, [](const Box3& face) { return face.max.x > 2; });
  EXPECT_EQ(wrong.fault, "a piece of a cell is on both sides of the body");
}

TEST(CellSplit, AFaceThatIsCutAlongAPartOfALineIsNotTrusted) {
  // A corner of the body within the cell, and one of the three faces that make it is not seen.
  const Slab corner{{{2, 2, 2}, {9, 9, 9}}};
  const ClippedCell right = split(corner, every_face);
  ASSERT_EQ(right.left, ClippedCell::Left::part) << right.fault;
  EXPECT_NEAR(volume_of(right.solid), 27, 1e-9);
  const ClippedCell wrong = split(corner, [](const Box3& face) { return face.max.x > 3; });
  EXPECT_NE(wrong.fault, "");
}

// The wall of a groove passes beside where a ball's pole was, and the line along which it cuts the ball ended there.
TEST(CellSplit, PolesOfBallsAreInStruts) {
  constexpr double size = 3;
  LatticeCell star_cell{.box = {{0, 0, 0}, {size, size, size}}, .primitives = {Ball{{1.5, 1.5, 1.5}, 0.56}}};
  for (int i = 0; i < 8; ++i)
    star_cell.primitives.push_back(
        Frustum{{i & 1 ? size : 0, i & 2 ? size : 0, i & 4 ? size : 0}, {1.5, 1.5, 1.5}, 0.3, 0.3});
  const SourceMap source;
  const RunOptions run;
  DiagnosticSink sink;
  const auto usual = cell_shape(star_cell, sink);
  ASSERT_TRUE(usual);
  const auto shape = with_poles_aside(*usual);
  ASSERT_TRUE(shape);
  const auto star = fuse(shape->solids, {}, {source, run, sink});
  ASSERT_TRUE(star && star->size() == 1);
  const gp_Pnt low(9.3 + 10, 5.7, -5.6), bottom(19.3, 5.7, 0.4), middle(17.8, 5.7, 1.9), top(19.3, 5.7, 3.4),
      high(19.3, 5.7, 6.4), axis_low(9.3, 5.7, -5.6), axis_high(9.3, 5.7, 6.4);
  BRepBuilderAPI_MakeWire outline;
  outline.Add(BRepBuilderAPI_MakeEdge(axis_low, low));
  outline.Add(BRepBuilderAPI_MakeEdge(low, bottom));
  outline.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(bottom, middle, top).Value()));
  outline.Add(BRepBuilderAPI_MakeEdge(top, high));
  outline.Add(BRepBuilderAPI_MakeEdge(high, axis_high));
  outline.Add(BRepBuilderAPI_MakeEdge(axis_high, axis_low));
  const TopoDS_Shape groove =
      BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Ax1(axis_low, gp::DZ())).Shape();
  WholeCell cell = whole_cell(star->front(), 0.03);
  LocalBody body = body_of(outward(groove), {}, every_face);
  body.contains = [](Vec3 p) {
    const double out = std::hypot(p.x - 9.3, p.y - 5.7), up = p.z - 1.9;
    return out < 10 && up > -7.5 && up < 4.5 && std::hypot(out - 10, up) > 1.5;
  };
  body.side = [contains = body.contains](Vec3 p) { return contains(p) ? 1 : -1; };
  const ClippedCell part = split_cell(cell, body, {.size = size}, {});
  ASSERT_EQ(part.left, ClippedCell::Left::part) << part.fault;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(-0.4, size + 0.4);  // struts end across their axes
  constexpr int count = 200000;
  int within = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 p{share(random), share(random), share(random)};
    within += body.contains(p) && signed_distance(star_cell.primitives, p) <= 0 ? 1 : 0;
  }
  const double of_box = static_cast<double>(within) / count, box = 3.8 * 3.8 * 3.8;
  EXPECT_NEAR(volume_of(part.solid), box * of_box, 4 * box * std::sqrt(of_box / count));
}

}  // namespace
}  // namespace meso::brep
