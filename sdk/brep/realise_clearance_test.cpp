// SPDX-License-Identifier: Apache-2.0
// What coarse triangles prove, and that nothing is proven without them. Truths: boxes side by side.
#include "realise_clearance.hpp"

#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <limits>

namespace meso::brep {
namespace {

TopoDS_Shape box_at(double x) { return BRepPrimAPI_MakeBox(gp_Pnt(x, 0, 0), 1, 1, 1).Solid(); }

std::vector<CarrierSurface> surfaces_of(const TopoDS_Shape& solid) {
  std::vector<CarrierSurface> out;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) out.emplace_back(TopoDS::Face(it.Current()));
  return out;
}

TEST(CoarseMesh, ProvesThatBoxesKeepApart) {
  const CoarseMesh first = coarse_mesh({box_at(0)}), second = coarse_mesh({box_at(3)});
  EXPECT_TRUE(proven_apart(surfaces_of(box_at(0)), first, second));
  EXPECT_FALSE(proven_apart(surfaces_of(box_at(0)), first, coarse_mesh({box_at(0.5)})));
}

TEST(CoarseMesh, NothingIsProvenWithoutTriangles) {
  const CoarseMesh second = coarse_mesh({box_at(3)}), none{.error = std::numeric_limits<double>::infinity()};
  for (const CarrierSurface& surface : surfaces_of(box_at(0))) EXPECT_EQ(proven_side(surface, none, 0), 0);
  EXPECT_FALSE(proven_apart(surfaces_of(box_at(0)), none, second));
  EXPECT_FALSE(proven_apart(surfaces_of(box_at(3)), second, none));
}

}  // namespace
}  // namespace meso::brep
