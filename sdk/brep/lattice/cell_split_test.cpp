// SPDX-License-Identifier: Apache-2.0
// What a cell and a body have in common, and what tells that faces of the body did not divide what they should have.
#include "lattice/cell_split.hpp"

#include <gtest/gtest.h>

#include "boolean.hpp"

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

}  // namespace
}  // namespace meso::brep
