// SPDX-License-Identifier: Apache-2.0
// What OpenCASCADE gets wrong without a word.
#include "boolean.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace meso::brep {
namespace {

using std::numbers::pi;

class Booleans : public ::testing::Test {
 protected:
  SourceMap source_;
  RunOptions run_;
  DiagnosticSink sink_;
  SolidContext context_{source_, run_, sink_};
};

TopoDS_Shape box(double size) { return BRepPrimAPI_MakeBox(size, size, size).Solid(); }
TopoDS_Shape ball(double x, double radius) { return BRepPrimAPI_MakeSphere(gp_Pnt(x, 5, 5), radius).Solid(); }

double volume(const std::optional<Solids>& solids) {
  double sum = 0;
  if (solids)
    for (const TopoDS_Shape& solid : *solids) sum += volume_of(solid);
  return sum;
}

TEST_F(Booleans, ReversedToolIsTurnedBeforeItIsUsed) {
  const Solids tool = solids_of(ball(5, 1).Reversed());
  ASSERT_EQ(tool.size(), 1u);
  EXPECT_GT(volume_of(tool.front()), 0);
  EXPECT_NEAR(volume(cut({box(10)}, tool, {}, context_)), 1000 - 4.0 / 3 * pi, 1e-6);
}

TEST_F(Booleans, OverlappingTools) {
  const double two = 8.0 / 3 * pi - 5 * pi / 12;  // unit balls at distance 1
  EXPECT_NEAR(volume(cut({box(10)}, {ball(4, 1), ball(5, 1)}, {}, context_)), 1000 - two, 1e-4);
  EXPECT_NEAR(volume(fuse({ball(4, 1), ball(5, 1), ball(8, 1)}, {}, context_)), two + 4.0 / 3 * pi, 1e-4);
}

TEST_F(Booleans, ToolThatTouchesFromInside) {
  EXPECT_NEAR(volume(cut({box(10)}, {ball(1, 1)}, {}, context_)), 1000 - 4.0 / 3 * pi, 1e-6);
}

TEST_F(Booleans, PartsThatTouchInALineAreReported) {
  // A cylinder along z that touches the side x = 0 of the box from inside leaves a wall of no thickness.
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(2, 5, -1), gp::DZ()), 2, 12).Solid();
  EXPECT_NEAR(volume(cut({box(10)}, {hole}, {}, context_)), 1000 - 40 * pi, 1e-6);
  ASSERT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_EQ(sink_.diagnostics().front().code, Code::geometry_non_manifold);
}

TEST_F(Booleans, EdgesOfOneFaceOnlyAreCounted) {
  TopExp_Explorer face(box(1), TopAbs_FACE);
  EXPECT_EQ(edge_uses(face.Current()).free, 4u);
  EXPECT_EQ(edge_uses(box(1)).free, 0u);
}

TEST_F(Booleans, AStopIsObeyed) {
  run_.cancelled = [] { return true; };
  EXPECT_FALSE(fuse({ball(4, 1), ball(5, 1)}, {}, context_));
  ASSERT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_EQ(sink_.diagnostics().front().code, Code::cancelled);
}

TEST_F(Booleans, ADeadlineIsObeyed) {
  run_.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_FALSE(fuse({ball(4, 1), ball(5, 1)}, {}, context_));
  ASSERT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_EQ(sink_.diagnostics().front().code, Code::limit_time);
}

}  // namespace
}  // namespace meso::brep
