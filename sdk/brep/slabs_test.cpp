// SPDX-License-Identifier: Apache-2.0
// A cut in slabs leaves what one cut leaves: volume by closed form, faces and edges by number.
#include "slabs.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "boolean.hpp"

namespace meso::brep {
namespace {

using std::numbers::pi;

struct Counts {
  int solids = 0, shells = 0, faces = 0, edges = 0, vertices = 0;
  bool operator==(const Counts&) const = default;
};
void PrintTo(const Counts& c, std::ostream* out) {
  *out << c.solids << " solids, " << c.shells << " shells, " << c.faces << " faces, " << c.edges << " edges, "
       << c.vertices << " vertices";
}

class Slabs : public ::testing::Test {
 protected:
  std::optional<Solids> in_slabs(const Solids& base, const std::vector<Solids>& clusters, std::size_t slab_tools) {
    return cut_in_slabs(base, clusters, slab_tools, {}, context_);
  }

  /// Cut in slabs of two tools and at once, by any number of threads.
  void expect_as_at_once(const Solids& base, const std::vector<Solids>& clusters, std::optional<double> volume = {}) {
    Solids tools;
    for (const Solids& cluster : clusters) tools.insert(tools.end(), cluster.begin(), cluster.end());
    const auto at_once = cut_at_once(base, tools, {}, context_);
    ASSERT_TRUE(at_once);
    for (const unsigned jobs : {1u, 3u}) {
      run_.jobs = jobs;
      const auto slabs = in_slabs(base, clusters, 2);
      ASSERT_TRUE(slabs);
      EXPECT_EQ(counts(*slabs), counts(*at_once));
      EXPECT_NEAR(sum(*slabs) / volume.value_or(sum(*at_once)), 1, 1e-9);
      for (const TopoDS_Shape& solid : *slabs) EXPECT_TRUE(BRepCheck_Analyzer(solid).IsValid());
    }
    EXPECT_TRUE(sink_.diagnostics().empty());
  }

  static double sum(const Solids& solids) {
    double sum = 0;
    for (const TopoDS_Shape& solid : solids) sum += volume_of(solid);
    return sum;
  }
  static Counts counts(const Solids& solids) {
    Counts all;
    for (const TopoDS_Shape& solid : solids) {
      const auto count = [&](TopAbs_ShapeEnum kind) {
        TopTools_IndexedMapOfShape shapes;
        TopExp::MapShapes(solid, kind, shapes);
        return shapes.Extent();
      };
      ++all.solids;
      all.shells += count(TopAbs_SHELL);
      all.faces += count(TopAbs_FACE);
      all.edges += count(TopAbs_EDGE);
      all.vertices += count(TopAbs_VERTEX);
    }
    return all;
  }

  SourceMap source_;
  RunOptions run_;
  DiagnosticSink sink_;
  SolidContext context_{source_, run_, sink_};
};

TopoDS_Shape plate() { return BRepPrimAPI_MakeBox(gp_Pnt(0, -10, -5), gp_Pnt(60, 10, 0)).Solid(); }
TopoDS_Shape ball(double x, double y, double z, double radius) {
  return BRepPrimAPI_MakeSphere(gp_Pnt(x, y, z), radius).Solid();
}

TEST_F(Slabs, BallsInOneFace) {
  std::vector<Solids> balls;
  for (int i = 0; i < 7; ++i) balls.push_back({ball(5 + 8 * i, i % 3 - 1, 0, 3)});
  expect_as_at_once({plate()}, balls, 6000 - 7 * 18 * pi);
}

TEST_F(Slabs, BallsAcrossEdgesThatSeveralSlabsCut) {
  std::vector<Solids> balls;
  for (int i = 0; i < 7; ++i) balls.push_back({ball(5 + 8 * i, i % 2 == 0 ? 10 : -10, 0, 3)});
  expect_as_at_once({plate()}, balls, 6000 - 7 * 9 * pi);
}

TEST_F(Slabs, CornersAndVoids) {
  expect_as_at_once(
      {plate()},
      {{ball(0, -10, 0, 2)}, {ball(60, -10, -5, 2)}, {ball(30, 0, -2.5, 1)}, {ball(60, 10, 0, 2)}, {ball(20, 0, 0, 2)}},
      6000 - (3.0 / 8 + 0.5) * 32 / 3 * pi - 4.0 / 3 * pi);
}

TEST_F(Slabs, SlabsTogetherDivideABodyThatNoneDividesAlone) {
  // A frame falls in two where both its long sides are cut through.
  const TopoDS_Shape window = BRepPrimAPI_MakeBox(gp_Pnt(10, -5, -9), gp_Pnt(50, 5, 9)).Solid();
  const auto frame = cut_at_once({plate()}, {window}, {}, context_);
  ASSERT_TRUE(frame);
  const auto saw = [](double x, double y) {
    return BRepPrimAPI_MakeBox(gp_Pnt(x, y, -9), gp_Pnt(x + 2, y + 9, 9)).Solid();
  };
  expect_as_at_once(*frame, {{saw(20, -12)}, {ball(5, 0, 0, 1)}, {saw(40, 3)}, {ball(55, 0, 0, 1)}},
                    6000 - 2000 - 2 * 2 * 5 * 5 - 4.0 / 3 * pi);
}

TEST_F(Slabs, RoundBodiesWithSeams) {
  const TopoDS_Shape rod = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(), gp::DX()), 6, 60).Solid();
  std::vector<Solids> blocks;
  for (int i = 0; i < 8; ++i) {
    const double angle = 0.1 + i * 0.25 * pi, y = 6 * std::cos(angle), z = 6 * std::sin(angle);
    blocks.push_back(
        {BRepPrimAPI_MakeBox(gp_Pnt(3 + 7 * i, y - 1.5, z - 1.4), gp_Pnt(6 + 7 * i, y + 1.5, z + 1.4)).Solid()});
  }
  expect_as_at_once({rod}, blocks);
}

TEST_F(Slabs, BodiesOfOneFace) {
  std::vector<Solids> balls;
  for (int i = 0; i < 4; ++i) balls.push_back({ball(10 * std::cos(0.3 + i * 1.5), 10 * std::sin(0.3 + i * 1.5), 1, 2)});
  expect_as_at_once({ball(0, 0, 0, 10)}, balls);
}

TEST_F(Slabs, MovedBodies) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 2)), 0.7);
  std::vector<Solids> balls;
  for (int i = 0; i < 5; ++i)
    balls.push_back({ball(5 + 8 * i, i % 2 == 0 ? 10 : 0, 0, 3).Moved(TopLoc_Location(turn))});
  expect_as_at_once({plate().Moved(TopLoc_Location(turn))}, balls, 6000 - 3 * 9 * pi - 2 * 18 * pi);
}

TEST_F(Slabs, AClusterAcrossAllSlabsStaysTogether) {
  // A rod along the plate touches half of the balls: together they are one cluster, larger than a slab.
  Solids chain{BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-1, 5, 0), gp::DX()), 1, 62).Solid()};
  std::vector<Solids> clusters;
  for (int i = 0; i < 4; ++i) chain.push_back(ball(5 + 14 * i, 5, 0, 3));
  for (int i = 0; i < 4; ++i) clusters.push_back({ball(5 + 14 * i, -5, 0, 3)});
  clusters.push_back(chain);
  expect_as_at_once({plate()}, clusters);
  expect_as_at_once({plate()}, {chain});
}

TEST_F(Slabs, BodiesOfSeveralSolids) {
  const TopoDS_Shape second = BRepPrimAPI_MakeBox(gp_Pnt(70, -10, -5), gp_Pnt(90, 10, 0)).Solid();
  const TopoDS_Shape third = BRepPrimAPI_MakeBox(gp_Pnt(100, -1, -1), gp_Pnt(101, 1, 0)).Solid();
  expect_as_at_once(
      {plate(), second, third},
      {{ball(5, 0, 0, 3)}, {ball(75, 0, 0, 3)}, {ball(35, 0, 0, 3)}, {ball(85, 0, 0, 3)}, {ball(100.5, 0, 0, 3)}},
      8000 - 4 * 18 * pi);
}

TEST_F(Slabs, AStopAndADeadlineAreObeyed) {
  const std::vector<Solids> balls{{ball(5, 0, 0, 3)}, {ball(25, 0, 0, 3)}, {ball(45, 0, 0, 3)}};
  run_.cancelled = [] { return true; };
  EXPECT_FALSE(in_slabs({plate()}, balls, 1));
  ASSERT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_EQ(sink_.diagnostics().front().code, Code::cancelled);
  run_.cancelled = {};
  run_.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_FALSE(in_slabs({plate()}, balls, 1));
  EXPECT_EQ(sink_.diagnostics().back().code, Code::limit_time);
}

}  // namespace
}  // namespace meso::brep
