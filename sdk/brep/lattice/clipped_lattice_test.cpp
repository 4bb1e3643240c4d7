// SPDX-License-Identifier: Apache-2.0
// Lattices cut by bodies of every kind, against closed forms and against counting points with the exact distances.
#include "lattice/clipped_lattice.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <numbers>
#include <random>
#include <span>

#include "lattice/primitive_field.hpp"
#include "lattice/test_cells.hpp"
#include "lattice/varied_cells.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

TopoDS_Shape box(Vec3 from, Vec3 to) { return BRepPrimAPI_MakeBox(to_pnt(from), to_pnt(to)).Solid(); }

TopoDS_Shape solid_in(const TopoDS_Shape& shape) { return TopExp_Explorer(shape, TopAbs_SOLID).Current(); }

struct Made {
  std::optional<ClippedLattice> lattice;
  Audit audit;
  double volume = 0;
};

/// Cells (0, 0, 0) ... `last` of the body-centred lattice in the body.
Made clipped(const std::vector<TopoDS_Shape>& body, const Index3& last, bool reuse = true, unsigned jobs = 0,
             std::optional<MeshFineness> mesh = {}) {
  DiagnosticSink sink;
  const auto cell = cell_shape(bcc(), sink);
  Made made;
  made.lattice = clipped_lattice_body(*cell, last, body, {.mesh = mesh, .reuse = reuse}, {.jobs = jobs}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  if (!made.lattice) return made;
  made.audit = audit(made.lattice->body);
  made.volume = measure(made.lattice->body).volume;
  return made;
}

/// Volume of the infinite lattice in a body, by points; and the standard error of that.
template <typename Inside>
std::pair<double, double> counted(const Box3& around, Inside inside) {
  const LatticeCell cell = bcc();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  constexpr int count = 400'000;
  const Vec3 size = around.max - around.min;
  int hits = 0;
  for (int n = 0; n < count; ++n) {
    Vec3 p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = around.min[i] + uniform(random) * size[i];
    if (!inside(p)) continue;
    for (std::size_t i = 0; i < 3; ++i) p[i] -= 5 * std::floor(p[i] / 5);
    hits += signed_distance(cell.primitives, p) < 0;
  }
  const double share = static_cast<double>(hits) / count, all = size.x * size.y * size.z;
  return {share * all, std::sqrt(share * (1 - share) / count) * all};
}

void expect_clean(const Made& made) {
  ASSERT_TRUE(made.lattice);
  EXPECT_EQ(made.audit.free_edges, 0u);
  EXPECT_EQ(made.audit.multiple_edges, 0u);
  EXPECT_EQ(made.audit.conflicts, 0u);
  EXPECT_EQ(made.audit.open_loops, 0u);
  EXPECT_TRUE(made.audit.clean());
}

TEST(ClippedLattice, ABoxOfWholePeriodsHoldsAsMuchWhereverItStands) {
  for (const Vec3 at : {Vec3{3.7, 3.3, 2.9}, Vec3{2.5, 5, 5}, Vec3{5.005, 5.005, 5.005}, Vec3{4.2, 5, 2.5}}) {
    const Made made = clipped({box(at, at + Vec3{10, 15, 10})}, {3, 4, 3});
    expect_clean(made);
    EXPECT_NEAR(made.volume / (12 * bcc_cell), 1, 1e-6);
    EXPECT_GT(made.lattice->crossing, 0u);
  }
}

TEST(ClippedLattice, WhatTheOutermostCellsSendOverTheirBoxesIsThere) {
  // One cell, 5 mm from the body's boundary: the whole of its balls and struts.
  const Made made = clipped({box({-4, -4, -4}, {9, 9, 9})}, {0, 0, 0});
  expect_clean(made);
  // Seven eighths of each corner ball are beyond the box.
  EXPECT_NEAR(made.volume, bcc_cell + 7 * 4.0 / 3 * pi * 0.9 * 0.9 * 0.9, 1e-4);
  EXPECT_EQ(made.lattice->body.fragments, 0u);
}

TEST(ClippedLattice, ReuseChangesNothingButTheTime) {
  const std::vector<TopoDS_Shape> body{box({1.3, 1.7, 2.1}, {17, 8, 4})};
  const Made once = clipped(body, {4, 2, 1}), each = clipped(body, {4, 2, 1}, false);
  expect_clean(once);
  expect_clean(each);
  EXPECT_LE(once.lattice->clip.distinct, 6u);
  EXPECT_EQ(each.lattice->clip.distinct, 8u);
  EXPECT_NEAR(once.volume, each.volume, 1e-9 * each.volume);
  EXPECT_EQ(once.audit.faces, each.audit.faces);
}

TEST(ClippedLattice, ConcaveBodies) {
  // An L whose inner walls lie on box planes in z only.
  const TopoDS_Shape whole = box({1, 1, 0}, {13, 13, 10}), notch = box({6, 7, -1}, {20, 20, 11});
  const TopoDS_Shape corner = BRepAlgoAPI_Cut(whole, notch).Shape();
  const Made made = clipped({solid_in(corner)}, {3, 3, 2});
  expect_clean(made);
  const auto [volume, error] = counted({{1, 1, 0}, {13, 13, 10}}, [](Vec3 p) { return p.x < 6 || p.y < 7; });
  EXPECT_NEAR(made.volume, volume, 4 * error);
}

// The line of contact begins where the strut in the plane ends: of three places on it one is beyond the strut.
TEST(ClippedLattice, AHoleMayTouchAPlaneBetweenBoxes) {
  constexpr double radius = 1.3;
  for (const double from : {0.0, 5.8}) {
    const Vec3 axis{5.3, 5 - radius, from};
    const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(to_pnt(axis), gp::DZ()), radius, 20).Solid();
    const Vec3 low{1.1, 1.2, 1.3}, high{14, 9, 9};
    const Made made = clipped({solid_in(BRepAlgoAPI_Cut(box(low, high), hole).Shape())}, {2, 1, 1});
    expect_clean(made);
    const auto [volume, error] =
        counted({low, high}, [&](Vec3 p) { return p.z < from || std::hypot(p.x - axis.x, p.y - axis.y) > radius; });
    EXPECT_NEAR(made.volume, volume, 4 * error);
    for (const std::size_t more : std::span(made.lattice->clip.attempts).subspan(1)) EXPECT_EQ(more, 0u);
  }
}

/// Directed segments without a partner, and the volume within; triangles without area are failures.
struct Triangles {
  std::size_t count = 0, unmatched = 0;
  double volume = 0;
};
Triangles triangles_in(const Body& body) {
  std::map<std::array<Vec3, 2>, int, decltype([](const auto& a, const auto& b) {
             const auto key = [](const auto& s) { return std::array{s[0].x, s[0].y, s[0].z, s[1].x, s[1].y, s[1].z}; };
             return key(a) < key(b);
           })>
      segments;
  Triangles found;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) {
      ++found.count;
      found.volume += dot(t[0], cross(t[1], t[2])) / 6;
      EXPECT_GT(norm(cross(t[1] - t[0], t[2] - t[0])), 0);
      for (std::size_t k = 0; k < 3; ++k) {
        ++segments[{t[k], t[(k + 1) % 3]}];
        --segments[{t[(k + 1) % 3], t[k]}];
      }
    }
  });
  for (const auto& [segment, times] : segments) found.unmatched += times > 0 ? static_cast<std::size_t>(times) : 0;
  return found;
}

TEST(ClippedLattice, TrianglesClose) {
  // In the third the walls all but touch the balls, in the fourth they pass a micrometre beside their middles.
  for (const Vec3 at : {Vec3{3.7, 3.3, 2.9}, Vec3{2.5, 5, 5}, Vec3{4.099, 4.1001, 2.5}, Vec3{5.001, 5, 7.499}}) {
    SCOPED_TRACE(at.x);
    const Made made = clipped({box(at, at + Vec3{5, 5, 5})}, {2, 2, 2}, true, 0, MeshFineness{0.05, 0.5});
    expect_clean(made);
    EXPECT_NEAR(made.volume / bcc_cell, 1, 1e-6);
    const Triangles triangles = triangles_in(made.lattice->body);
    EXPECT_EQ(triangles.unmatched, 0u);
    EXPECT_NEAR(triangles.volume / made.volume, 1, 0.05);
  }
}

TEST(ClippedLattice, TrianglesKeepToTheSurface) {
  // On the ball in the middle close circles leave the mesher little room.
  const Made made = clipped({box({3.7, 3.3, 2.9}, {8.7, 5, 5})}, {1, 1, 1}, true, 0, MeshFineness{0.025, 0.5});
  expect_clean(made);
  const std::vector<CellPrimitive> primitives = bcc().primitives;
  const auto off_by = [&](Vec3 p) {
    for (std::size_t i = 0; i < 3; ++i) p[i] -= 5 * std::floor(p[i] / 5);
    return std::fabs(signed_distance(primitives, p));
  };
  double worst = 0;
  for (const FaceTemplate& face : made.lattice->body.solids.at(0).outer.geometry->faces) {
    if (std::holds_alternative<Plane>(face.surface)) continue;
    for (const auto& triangle : face.mesh.triangles) {
      std::array<Vec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const MeshPoint& p = face.mesh.points[triangle[k]];
        for (std::size_t i = 0; i < 3; ++i) corners[k][i] = p.point[i] + 5.0 * p.offset[i];
      }
      for (int i = 0; i <= 8; ++i)
        for (int j = 0; i + j <= 8; ++j)
          worst = std::fmax(worst, off_by(corners[0] + (i / 8.0) * (corners[1] - corners[0]) +
                                          (j / 8.0) * (corners[2] - corners[0])));
    }
  }
  EXPECT_LT(worst, 0.025 * 4 / 3);  // segments are within the deflection, the middle of a triangle a third more
  EXPECT_GT(worst, 0.01);
}

TEST(ClippedLattice, CylinderAndSphere) {
  const TopoDS_Shape rod = BRepPrimAPI_MakeCylinder(gp_Ax2({8.1, 7.7, 1.2}, gp::DZ()), 2.2, 16).Solid();
  const Made in_rod = clipped({rod}, {3, 3, 3});
  expect_clean(in_rod);
  const auto [rod_volume, rod_error] =
      counted({{5, 5, 1.2}, {11, 10, 17.2}}, [](Vec3 p) { return std::hypot(p.x - 8.1, p.y - 7.7) < 2.2; });
  EXPECT_NEAR(in_rod.volume, rod_volume, 4 * rod_error);
  EXPECT_EQ(in_rod.lattice->clip.distinct, 6u);  // two cells a layer: both ends, and two layers that look alike

  const TopoDS_Shape globe = BRepPrimAPI_MakeSphere(gp_Pnt(8.1, 7.7, 8.2), 4).Solid();
  const Made in_globe = clipped({globe}, {3, 3, 3});
  expect_clean(in_globe);
  const auto [volume, error] = counted({{4, 3, 4}, {13, 12, 13}}, [](Vec3 p) {
    return norm(p - Vec3{8.1, 7.7, 8.2}) < 4;
  });
  EXPECT_NEAR(in_globe.volume, volume, 4 * error);
}

TEST(ClippedLattice, ThreadsDoNotShowInTheResult) {
  const std::vector<TopoDS_Shape> body{box({1.3, 1.7, 2.1}, {7, 8, 4})};
  const MeshFineness mesh{0.05, 0.5};
  const Made one = clipped(body, {1, 1, 0}, true, 1, mesh), three = clipped(body, {1, 1, 0}, true, 3, mesh);
  ASSERT_TRUE(one.lattice && three.lattice);
  const Template &a = *one.lattice->body.solids.at(0).outer.geometry,
                 &b = *three.lattice->body.solids.at(0).outer.geometry;
  EXPECT_EQ(a.vertices, b.vertices);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t f = 0; f < a.faces.size(); ++f) {
    EXPECT_EQ(a.faces[f].moments.volume_moment, b.faces[f].moments.volume_moment);
    EXPECT_EQ(a.faces[f].mesh.triangles, b.faces[f].mesh.triangles);
  }
}

TEST(ClippedLattice, StopsWhenAsked) {
  DiagnosticSink sink;
  const auto cell = cell_shape(bcc(), sink);
  int polls = 0;
  const RunOptions run{.jobs = 1, .cancelled = [&] { return ++polls > 20; }};
  EXPECT_FALSE(clipped_lattice_body(*cell, {3, 3, 3}, {box({1.3, 1.7, 2.1}, {12, 14, 13})}, {}, run, sink));
  ASSERT_FALSE(sink.diagnostics().empty());
  EXPECT_EQ(sink.diagnostics().back().code, Code::cancelled);
}

// Pillars that end flat in the walls of their boxes, each as thick as no other: a boolean each.
TEST(ClippedLattice, BooleansOfCellsThatVaryAreCounted) {
  constexpr std::int32_t count = 3;
  LatticeCell cell{.box = {{0, 0, 0}, {4, 4, 4}}, .primitives = {}};
  auto varied = std::make_shared<VariedCells>(Index3{count - 1, 0, 0});
  double area = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    const double radius = 0.5 + 0.1 * i;
    cell.primitives.emplace_back(Frustum{{2, 2, 0}, {2, 2, 4}, radius, radius});
    varied->set({i, 0, 0}, {static_cast<std::uint32_t>(i)});
    area += pi * radius * radius;
  }
  DiagnosticSink sink;
  auto shape = cell_shape(cell, sink);
  ASSERT_TRUE(shape);
  shape->varied = varied;
  const auto made = [&](const FusedLimit& fused) {
    sink = DiagnosticSink();
    return clipped_lattice_body(*shape, {count - 1, 0, 0}, {}, {.fused = fused}, {}, sink);
  };
  const auto all = made({count});
  ASSERT_TRUE(all);
  EXPECT_NEAR(measure(all->body).volume, 4 * area, 1e-9);
  EXPECT_FALSE(made({count - 1}));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics().front().code, Code::limit_booleans);
  // Nothing is told where another way is to be tried.
  EXPECT_FALSE(made({count - 1, false}));
  EXPECT_TRUE(sink.diagnostics().empty());
}

}  // namespace
}  // namespace meso::brep
