// SPDX-License-Identifier: Apache-2.0
// Lattices and bodies that are united with them, against closed forms and against counting points.
#include "lattice/united_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>

#include "lattice/clipped_lattice.hpp"
#include "lattice/primitive_field.hpp"
#include "lattice/test_cells.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double node = 4.0 / 3 * pi * 0.9 * 0.9 * 0.9;

using Bodies = std::vector<TopoDS_Shape>;

TopoDS_Shape box(Vec3 from, Vec3 to) { return BRepPrimAPI_MakeBox(to_pnt(from), to_pnt(to)).Solid(); }

/// Cells (0, 0, 0) ... `last` cut to `body`, if there is one, and united with `added`: closed, of that volume.
std::optional<ClippedLattice> united(const Bodies& body, const Bodies& added, const Index3& last, double volume,
                                     double tolerance = 1e-6) {
  DiagnosticSink sink;
  const auto cell = cell_shape(bcc(), sink);
  auto made = clipped_lattice_body(*cell, last, body, {.added = added}, {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  EXPECT_TRUE(made);
  if (!made) return {};
  EXPECT_TRUE(audit(made->body).clean());
  EXPECT_NEAR(measure(made->body).volume, volume, tolerance * volume);
  return made;
}

const TopoDS_Shape two_by_two = box({0, 0, 0}, {10, 10, 10});
constexpr Index3 second{1, 1, 1};

TEST(UnitedCells, SheetsBesideTheCells) {
  const auto made =
      united({two_by_two}, {box({0, 0, -1}, {10, 10, 0}), box({0, 0, 10}, {10, 10, 11})}, second, 8 * bcc_cell + 200);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->body.solids.size(), 1u);
  EXPECT_EQ(made->kept, 8u);
  EXPECT_EQ(made->crossing, 0u);
}

TEST(UnitedCells, SheetsOfWholeBoxesAndBeyondTheCells) {
  united({two_by_two}, {box({-7, -5, -5}, {13, 10, 5})}, second, 4 * bcc_cell + 20 * 15 * 10);
}

TEST(UnitedCells, ASheetWithinTheOutermostCells) {
  // Half of a cell is the mirror image of the other half.
  united({two_by_two}, {box({0, 0, 7.5}, {10, 10, 10})}, second, 6 * bcc_cell + 250);
  united({two_by_two}, {box({-3, -2, 7.5}, {14, 13, 10.5})}, second, 6 * bcc_cell + 17 * 15 * 3);
}

TEST(UnitedCells, AFrameAroundThem) {
  const TopoDS_Shape frame = BRepAlgoAPI_Cut(box({-4, -4, 0}, {14, 14, 10}), box({0, 0, -1}, {10, 10, 11})).Shape();
  united({two_by_two}, {TopExp_Explorer(frame, TopAbs_SOLID).Current()}, second, 8 * bcc_cell + (18 * 18 - 100) * 10.0);
}

TEST(UnitedCells, ALatticeThatIsNotCutGrowsOnAPlate) {
  // One cell with the whole of its balls, four of which are in the plate by half.
  const auto made = united({}, {box({-3, -3, -2}, {8, 8, 0})}, {}, bcc_cell + 7 * node - 2 * node + 11 * 11 * 2);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->kept, 1u);
}

TEST(UnitedCells, ABodyThatTouchesNothing) {
  const auto made = united({two_by_two}, {box({31, 1, 1}, {33, 2, 2})}, second, 8 * bcc_cell + 2);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->body.solids.size(), 2u);
}

TEST(UnitedCells, ABodyThatSwallowsThem) {
  const auto made = united({two_by_two}, {box({-1, -2, -3}, {11, 12, 13})}, second, 12.0 * 14 * 16);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->body.solids.size(), 1u);
}

TEST(UnitedCells, ABodyThatReachesFarBeyondAFewCellsIsLeftToBooleans) {
  DiagnosticSink sink;
  const auto cell = cell_shape(bcc(), sink);
  const TopoDS_Shape tilted = box({-1, -1, -1}, {200, 200, 1}).Moved(TopLoc_Location([] {
    gp_Trsf turn;
    turn.SetRotation(gp_Ax1(gp::Origin(), gp_Dir(1, 2, 0)), 0.3);
    return turn;
  }()));
  EXPECT_FALSE(clipped_lattice_body(*cell, {}, {}, {.added = {tilted}}, {}, sink));
  ASSERT_FALSE(sink.diagnostics().empty());
  EXPECT_EQ(sink.diagnostics().front().code, Code::geometry_not_repeatable);
}

/// Points of a cube around the 2 x 2 x 2 cells that are in the cut lattice or in the body, by volume; and its error.
template <typename Inside>
std::pair<double, double> counted(const Inside& in_added) {
  const LatticeCell cell = bcc();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-3, 13);
  constexpr int count = 300'000;
  int hits = 0;
  for (int n = 0; n < count; ++n) {
    Vec3 p{uniform(random), uniform(random), uniform(random)};
    bool in_block = true;
    for (std::size_t i = 0; i < 3; ++i) in_block = in_block && p[i] > 0 && p[i] < 10;
    const bool added = in_added(p);
    for (std::size_t i = 0; i < 3; ++i) p[i] -= 5 * std::floor(p[i] / 5);
    hits += added || (in_block && signed_distance(cell.primitives, p) < 0);
  }
  const double share = static_cast<double>(hits) / count, all = 16 * 16 * 16;
  return {share * all, std::sqrt(share * (1 - share) / count) * all};
}

TEST(UnitedCells, CurvedBodies) {
  const auto [of_ball, ball_error] = counted([](Vec3 p) { return norm(p - Vec3{4.7, 5.2, 5.1}) < 3.3; });
  united({two_by_two}, {BRepPrimAPI_MakeSphere(gp_Pnt(4.7, 5.2, 5.1), 3.3).Solid()}, second, of_ball,
         4 * ball_error / of_ball);
  // The seam of a torus shows in one of two boxes that share a wall: the lattice ends where the torus goes on.
  const auto [of_torus, torus_error] = counted([](Vec3 p) {
    const double out = std::hypot(p.x - 5, p.y - 5) - 4;
    return std::hypot(out, p.z - 10.5) < 1.3;
  });
  const TopoDS_Shape torus = BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(5, 5, 10.5), gp::DZ()), 4, 1.3).Solid();
  united({two_by_two}, {torus}, second, of_torus, 4 * torus_error / of_torus);
}

TEST(UnitedCells, MeshesAreClosed) {
  DiagnosticSink sink;
  const auto cell = cell_shape(bcc(), sink);
  const auto made =
      clipped_lattice_body(*cell, second, {two_by_two},
                           {.mesh = MeshFineness{0.05, 0.5}, .added = {box({-1, 0, 6}, {9, 10, 13})}}, {}, sink);
  ASSERT_TRUE(made);
  std::map<std::array<std::array<double, 3>, 2>, int> segments;  // by their ends, once in each direction
  visit_triangles(made->body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 a = t[i], b = t[(i + 1) % 3];
        const std::array<double, 3> from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
        segments[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
      }
  });
  EXPECT_GT(segments.size(), 1000u);
  EXPECT_TRUE(std::ranges::all_of(segments, [](const auto& segment) { return segment.second == 0; }));
}

}  // namespace
}  // namespace meso::brep
