// SPDX-License-Identifier: Apache-2.0
// Whole cells: which of them a boundary rule takes, and their union, against closed forms.
#include "lattice/cell_selection.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"

namespace meso::brep {
namespace {

constexpr double bcc_cell = 22.928246067499;  // a = 5, r = 0.5, R = 0.9, by inclusion and exclusion
constexpr double ball = 4.0 / 3 * std::numbers::pi * 0.9 * 0.9 * 0.9;

CellShape bcc() {
  LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Ball{{2.5, 2.5, 2.5}, 0.9}}};
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 5.0 : 0, i & 2 ? 5.0 : 0, i & 4 ? 5.0 : 0};
    cell.primitives.push_back(Ball{corner, 0.9});
    cell.primitives.push_back(Frustum{corner, {2.5, 2.5, 2.5}, 0.5, 0.5});
  }
  DiagnosticSink sink;
  return *cell_shape(cell, sink);
}

TopoDS_Shape box(Vec3 from, Vec3 to) { return BRepPrimAPI_MakeBox(to_pnt(from), to_pnt(to)).Solid(); }

double union_volume(const LatticeSet& set) {
  DiagnosticSink sink;
  const auto body = lattice_union(bcc(), set, {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  if (!body) return 0;
  EXPECT_TRUE(audit(*body).clean());
  return measure(*body).volume;
}

TEST(CellSelection, UnionsOfWholeCellsAddUp) {
  // Every ball is whole, every strut is in its box: only balls on the surface stick out.
  const LatticeSet block{.min = {}, .max = {2, 1, 0}, .inside = [](Index3) { return true; }};
  EXPECT_NEAR(union_volume(block), 6 * bcc_cell + (4 * 3 * 2 - 6) * ball, 1e-4);
  // Two cells that share an edge of their boxes: two balls.
  const LatticeSet two{.min = {}, .max = {1, 1, 0}, .inside = [](Index3 i) { return i[0] == i[1]; }};
  EXPECT_NEAR(union_volume(two), 2 * bcc_cell + (14 - 2) * ball, 1e-4);
}

/// A ball that reaches over one wall of its box by 0.5.
CellShape ball_over_a_wall() {
  DiagnosticSink sink;
  return *cell_shape({.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Ball{{0.5, 2.5, 2.5}, 1}}}, sink);
}

/// How many of the cells (0, 0, 0) ... `last` are taken; -1 after a fault.
std::int64_t taken(const CellShape& cell, const Index3& last, const TopoDS_Shape& body, const CellRule& rule) {
  DiagnosticSink sink;
  const auto selection = select_cells(cell, last, {body}, rule, {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return selection ? static_cast<std::int64_t>(selection->kept) : -1;
}
std::int64_t taken(const TopoDS_Shape& body, const CellRule& rule) { return taken(bcc(), {2, 2, 2}, body, rule); }

TEST(CellSelection, BoxesInsideOrMet) {
  const CellRule inside{BoundaryRule::drop_partial}, met{BoundaryRule::keep_whole};
  EXPECT_EQ(taken(box({1, 1, 1}, {14, 14, 14}), inside), 1);
  EXPECT_EQ(taken(box({1, 1, 1}, {14, 14, 14}), met), 27);
  EXPECT_EQ(taken(box({5, 5, 5}, {10, 15, 10}), inside), 2);  // touches all, and that is not to meet
  EXPECT_EQ(taken(box({5, 5, 5}, {10, 15, 10}), met), 2);
  EXPECT_EQ(taken(box({6, 6, 6}, {9, 9, 9}), met), 1);
  EXPECT_EQ(taken(box({4.999, 6, 6}, {9, 9, 9}), met), 2);
  EXPECT_EQ(taken(BRepPrimAPI_MakeSphere(gp_Pnt(7.5, 7.5, 7.5), 4.34).Solid(), inside), 1);  // corners are at 4.33
  EXPECT_EQ(taken(BRepPrimAPI_MakeSphere(gp_Pnt(7.5, 7.5, 7.5), 4.25).Solid(), inside), 0);
}

TEST(CellSelection, BodiesReachOverTheirBoxes) {
  const CellRule inside{BoundaryRule::drop_partial, InsideTest::body}, met{BoundaryRule::keep_whole, InsideTest::body};
  const CellShape cell = ball_over_a_wall();
  EXPECT_EQ(taken(cell, {}, box({-0.55, 1, 1}, {2, 4, 4}), inside), 1);
  EXPECT_EQ(taken(cell, {}, box({-0.45, 1, 1}, {2, 4, 4}), inside), 0);
  EXPECT_EQ(taken(cell, {1, 0, 0}, box({-0.45, 1, 1}, {7, 4, 4}), inside), 1);  // the second one
  EXPECT_EQ(taken(cell, {}, box({2, 0.5, 0.5}, {3, 1.5, 1.5}), met), 0);        // in the box, clear of the ball
  EXPECT_EQ(taken(cell, {}, box({-0.45, 2.4, 2.4}, {-0.1, 2.6, 2.6}), met), 1);
}

TEST(CellSelection, Clearance) {
  const auto with = [](double clearance, InsideTest test = InsideTest::box) {
    return CellRule{BoundaryRule::drop_partial, test, clearance};
  };
  const CellShape cell = ball_over_a_wall();
  const TopoDS_Shape cube = box({-1, -1, -1}, {6, 6, 6});
  const TopoDS_Shape globe = BRepPrimAPI_MakeSphere(gp_Pnt(2.5, 2.5, 2.5), 5).Solid();
  EXPECT_EQ(taken(cell, {}, cube, with(1)), 1);
  EXPECT_EQ(taken(cell, {}, cube, with(1.001)), 0);
  EXPECT_EQ(taken(cell, {}, cube, with(0.5, InsideTest::body)), 1);
  EXPECT_EQ(taken(cell, {}, cube, with(0.501, InsideTest::body)), 0);
  EXPECT_EQ(taken(cell, {}, globe, with(0.66)), 1);  // 5 - 4.33
  EXPECT_EQ(taken(cell, {}, globe, with(0.68)), 0);
}

}  // namespace
}  // namespace meso::brep
