// SPDX-License-Identifier: Apache-2.0
#include "facet_tree.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "boolean.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

const Affine here;

FacetTree tree_of(const TopoDS_Shape& solid) { return FacetTree(*facets_of({solid})); }
FacetTree cube(double edge) { return tree_of(BRepPrimAPI_MakeBox(edge, edge, edge).Solid()); }

double volume_of(const std::vector<Triangle>& triangles) {
  double volume = 0;
  for (const Triangle& t : triangles) volume += dot(t[0], cross(t[1], t[2])) / 6;
  return volume;
}

TEST(FacetsOf, AreTheBodyWhateverItsFacesHave) {
  const TopoDS_Shape frame =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(4, 4, 1).Solid(), BRepPrimAPI_MakeBox(gp_Pnt(1, 1, -1), 2, 2, 3).Solid());
  const auto facets = facets_of(solids_of(frame));  // two faces with a hole
  ASSERT_TRUE(facets);
  EXPECT_NEAR(volume_of(*facets), 12, 1e-12);
  const auto mirrored = facets_of(
      {mapped(BRepPrimAPI_MakeBox(4, 4, 1).Solid(), {Mat3::from_columns({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}), {}})});
  ASSERT_TRUE(mirrored);
  EXPECT_NEAR(volume_of(*mirrored), 16, 1e-12);
  EXPECT_FALSE(facets_of({BRepPrimAPI_MakeSphere(1).Solid()}));
  EXPECT_FALSE(facets_of({BRepPrimAPI_MakeCylinder(1, 2).Solid()}));
}

TEST(FacetTree, KnowsInsideFromOutside) {
  const FacetTree tree = cube(2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-0.5, 2.5);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{at(random), at(random), at(random)};
    const bool inside = p.x > 0 && p.x < 2 && p.y > 0 && p.y < 2 && p.z > 0 && p.z < 2;
    ASSERT_EQ(tree.contains(p), inside) << p.x << ' ' << p.y << ' ' << p.z;
  }
  // The first ray passes exactly through a corner.
  EXPECT_TRUE(tree.contains(Vec3{2, 2, 2} - 0.7 * Vec3{0.5773, 0.3114, 0.7548}));
  EXPECT_FALSE(tree.contains(Vec3{0, 0, 0} - 0.25 * Vec3{0.5773, 0.3114, 0.7548}));
}

TEST(FacetTree, MeasuresGapsBetweenFacesEdgesAndCorners) {
  const FacetTree a = cube(2), b = cube(1);
  const auto gap_is = [&](const Affine& placement, double gap) {
    EXPECT_TRUE(a.is_within(gap + 1e-9, b, placement));
    EXPECT_FALSE(a.is_within(gap - 1e-9, b, placement));
  };
  gap_is(Affine::from_translation({2.25, 0.3, 0.4}), 0.25);  // face to face
  gap_is(Affine::from_translation({2.3, 2.4, 0.5}), 0.5);    // edge to parallel edge
  gap_is(Affine::from_translation({2.2, 2.1, 2.2}), 0.3);    // corner to corner
  gap_is(Affine::from_translation({0.5, 0.5, 0.75}), 0.25);  // inside
  const Mat3 upright = rotation({0, 0, 1}, std::numbers::pi / 4);
  gap_is({upright, {2.5, 1, 3}}, 1);  // edge above a face that ends
  // Edge across edge, both pointing at the other.
  const double h = std::sqrt(0.5);
  const Vec3 away{0, h, h}, side{1, 0, 0}, along = cross(side, away);
  const Mat3 turned = Mat3::from_columns(h * (away + side), h * (away - side), along);
  gap_is({turned, Vec3{1, 2, 2} + 0.4 * away - 0.5 * along}, 0.4);
  EXPECT_TRUE(a.is_within(0, b, Affine::from_translation({1.5, 1.5, 1.5})));
  EXPECT_TRUE(a.is_within(0, b, Affine::from_translation({2, 0.5, 0.5})));  // touches
}

TEST(FacetTree, PiercedByAnEdgeAloneIsMet) {
  const FacetTree plate = tree_of(BRepPrimAPI_MakeBox(10, 10, 1).Solid());
  const FacetTree needle = tree_of(BRepPrimAPI_MakeBox(0.1, 0.1, 8).Solid());
  EXPECT_TRUE(plate.is_within(0, needle, Affine::from_translation({3.3, 4.4, -4})));
  EXPECT_FALSE(plate.is_within(1.9, needle, Affine::from_translation({3.3, 4.4, 2.95})));
}

TEST(FacetTree, ASimilarityScalesTheOther) {
  const FacetTree a = cube(2), b = cube(12);
  const Affine small{Mat3::from_columns({1.0 / 12, 0, 0}, {0, 1.0 / 12, 0}, {0, 0, 1.0 / 12}), {2.5, 0, 0}};
  EXPECT_TRUE(a.is_within(0.5 + 1e-9, b, small));
  EXPECT_FALSE(a.is_within(0.5 - 1e-9, b, small));
}

}  // namespace
}  // namespace meso::brep
