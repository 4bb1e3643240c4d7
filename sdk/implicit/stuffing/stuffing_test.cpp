// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/stuffing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>

#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {
namespace {

using testing::ElementsAre;
constexpr double pi = std::numbers::pi;

std::optional<TetMesh> stuffed(const Field& field, const Box3& box, double spacing, const RunOptions& run = {},
                               DiagnosticSink* sink = nullptr) {
  const BccLattice lattice = bcc_lattice(box, spacing);
  const auto corners = compile(field.term(), lattice.corners), centres = compile(field.term(), lattice.centres);
  DiagnosticSink own;
  return stuff(lattice, *corners, *centres, run, sink != nullptr ? *sink : own);
}

Field gyroid() {
  DiagnosticSink sink;
  return *Field::surface("gyroid", sink);
}

/// Edges of the boundary that do not lie in exactly two of its faces, one in each direction.
std::size_t faulty_edges(const TetMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> there, back;
  for (const TetMesh::Face& f : mesh.boundary) {
    const auto c = mesh.corners(f);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = c[i], b = c[(i + 1) % 3];
      ++(a < b ? there : back)[{std::min(a, b), std::max(a, b)}];
    }
  }
  std::size_t faults = 0;
  for (const auto& [edge, n] : there) faults += n != 1 || back[edge] != 1 ? 1 : 0;
  for (const auto& [edge, n] : back) faults += n != 1 || there[edge] != 1 ? 1 : 0;
  return faults;
}

/// By the divergence theorem, from the boundary alone.
double enclosed(const TetMesh& mesh) {
  double six = 0;
  for (const TetMesh::Face& f : mesh.boundary) {
    const auto c = mesh.corners(f);
    six += dot(mesh.points[c[0]], cross(mesh.points[c[1]], mesh.points[c[2]]));
  }
  return six / 6;
}

/// By side of the box, then the surface.
std::array<double, TetMesh::side_count> areas(const TetMesh& mesh) {
  std::array<double, TetMesh::side_count> area{};
  for (const TetMesh::Face& f : mesh.boundary) {
    const auto c = mesh.corners(f);
    area[static_cast<std::size_t>(f.side)] +=
        norm(cross(mesh.points[c[1]] - mesh.points[c[0]], mesh.points[c[2]] - mesh.points[c[0]])) / 2;
  }
  return area;
}

double least_volume(const TetMesh& mesh) {
  double least = HUGE_VAL;
  for (const auto& t : mesh.tets) {
    const Vec3 o = mesh.points[t[0]];
    least = std::min(least, dot(cross(mesh.points[t[1]] - o, mesh.points[t[2]] - o), mesh.points[t[3]] - o) / 6);
  }
  return least;
}

void expect_sound(const TetMesh& mesh, double spacing) {
  const TetQuality q = tet_quality(mesh);
  EXPECT_GE(q.min_dihedral, min_dihedral_bound);
  EXPECT_LE(q.max_dihedral, max_dihedral_bound);
  EXPECT_GT(least_volume(mesh), 1e-3 * spacing * spacing * spacing);
  EXPECT_NEAR(enclosed(mesh), q.volume, 1e-9 * q.volume);
}

TEST(Stuffing, BallHasItsVolumeAndAClosedBoundaryOnIt) {
  const auto mesh = stuffed(Field::ball(1), {{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}}, 0.1);
  ASSERT_TRUE(mesh);
  expect_sound(*mesh, 0.1);
  EXPECT_EQ(faulty_edges(*mesh), 0u);
  EXPECT_NEAR(tet_quality(*mesh).volume, 4 * pi / 3, 0.01 * 4 * pi / 3);
  for (const TetMesh::Face& f : mesh->boundary)
    for (const std::uint32_t p : mesh->corners(f)) EXPECT_NEAR(norm(mesh->points[p]), 1, 1e-5 * 0.1);
}

TEST(Stuffing, VolumeConvergesWithTheSquareOfTheSpacing) {
  const auto error = [](double h) {
    return 4 * pi / 3 - tet_quality(*stuffed(Field::ball(1), {{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}}, h)).volume;
  };
  EXPECT_NEAR(error(0.12) / error(0.06), 4, 0.4);
}

TEST(Stuffing, BoxIsFilledToItsEdges) {
  const Box3 box{{-1, 0, 0}, {1, 1, 3}};
  const auto mesh = stuffed(Field::ball(100), box, 0.13);
  ASSERT_TRUE(mesh);
  expect_sound(*mesh, 0.13);
  EXPECT_EQ(faulty_edges(*mesh), 0u);
  EXPECT_NEAR(tet_quality(*mesh).volume, 6, 1e-9);
  const auto area = areas(*mesh);
  const auto near = [](double a) { return testing::DoubleNear(a, 1e-9); };
  EXPECT_THAT(area, ElementsAre(near(3), near(3), near(6), near(6), near(2), near(2), near(0)));
}

TEST(Stuffing, BoxOfUnrelatedSidesLosesNoMoreThanItsEdges) {
  const Box3 box{{0, 0, 0}, {1, 1.2345678, 0.7654321}};
  const auto mesh = stuffed(Field::ball(100), box, 0.1);
  ASSERT_TRUE(mesh);
  expect_sound(*mesh, 0.1);
  EXPECT_EQ(faulty_edges(*mesh), 0u);
  const double volume = 1.2345678 * 0.7654321;
  EXPECT_LT(tet_quality(*mesh).volume, volume + 1e-12);
  EXPECT_GT(tet_quality(*mesh).volume, 0.985 * volume);
}

TEST(Stuffing, GyroidIsClosedManifoldAndHalfTheBox) {
  const auto mesh = stuffed(gyroid(), {{0, 0, 0}, {2, 2, 2}}, 0.06);
  ASSERT_TRUE(mesh);
  expect_sound(*mesh, 0.06);
  EXPECT_EQ(faulty_edges(*mesh), 0u);
  EXPECT_NEAR(tet_quality(*mesh).volume, 4, 0.06);  // its two sides are alike
  const Field field = gyroid();
  for (const TetMesh::Face& f : mesh->boundary) {
    if (f.side != TetMesh::Side::surface) continue;
    for (const std::uint32_t p : mesh->corners(f)) EXPECT_LT(field.value(mesh->points[p]), 1e-5);
  }
}

/// The share of inside points of a side.
double section(const Field& field, const Box3& box, std::size_t side) {
  constexpr int along = 700;
  const std::size_t axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3 size = box.max - box.min;
  int count = 0;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j) {
      Vec3 p = side % 2 == 0 ? box.min : box.max;
      p[u] = box.min[u] + (i + 0.437) / along * size[u];
      p[v] = box.min[v] + (j + 0.521) / along * size[v];
      count += field.value(p) < 0 ? 1 : 0;
    }
  return size[u] * size[v] * count / along / along;
}

TEST(Stuffing, FacesOfTheBoxAreTheSolidsSections) {
  const Field field = gyroid();
  const Box3 box{{0, 0, 0}, {2, 2, 2}};
  for (const auto& [spacing, share, of_volume] : {std::array{0.06, 0.025, 1e-3}, std::array{0.03, 0.012, 2e-4}}) {
    const auto mesh = stuffed(field, box, spacing);
    ASSERT_TRUE(mesh);
    expect_sound(*mesh, spacing);
    EXPECT_EQ(faulty_edges(*mesh), 0u);
    EXPECT_NEAR(tet_quality(*mesh).volume, 4, 4 * of_volume);
    const auto area = areas(*mesh);
    for (std::size_t side = 0; side < 6; ++side) {
      const double whole = section(field, box, side);
      EXPECT_NEAR(area[side], whole, share * whole) << side;
    }
  }
}

TEST(Stuffing, AnyFieldKeepsTheBound) {
  // As rough as the lattice: every stencil occurs.
  DiagnosticSink sink;
  const auto rough = Field::expression("sin(70*x+3*y)*sin(67*y+z)+sin(73*z+2*x)+0.3*sin(41*x-59*y+83*z)", sink);
  ASSERT_TRUE(rough);
  const auto mesh = stuffed(*rough, {{-1, -1, -1}, {1, 1, 1}}, 0.05);
  ASSERT_TRUE(mesh);
  EXPECT_GT(mesh->tets.size(), 100'000u);
  expect_sound(*mesh, 0.05);
  EXPECT_LT(tet_quality(*mesh).min_dihedral, 0.25);
}

TEST(Stuffing, EqualMeshesForAnyNumberOfThreads) {
  const Box3 box{{0, 0, 0}, {1, 1, 1.1}};
  const auto one = stuffed(gyroid(), box, 0.05, {.jobs = 1}), three = stuffed(gyroid(), box, 0.05, {.jobs = 3});
  EXPECT_EQ(one->points, three->points);
  EXPECT_EQ(one->tets, three->tets);
  EXPECT_EQ(one->boundary, three->boundary);
}

TEST(Stuffing, NothingIsNoTetrahedra) {
  const auto mesh = stuffed(Field::ball(1), {{2, 2, 2}, {3, 3, 3}}, 0.1);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(mesh->tets.empty() && mesh->points.empty() && mesh->boundary.empty());
}

TEST(Stuffing, FieldsWithoutValuesAreOutside) {
  DiagnosticSink sink;
  const auto half = Field::expression("sqrt(x) - 2", sink);
  const auto mesh = stuffed(*half, {{-1, -1, -1}, {1, 1, 1}}, 0.17);
  ASSERT_TRUE(mesh);
  expect_sound(*mesh, 0.17);
  EXPECT_NEAR(tet_quality(*mesh).volume, 4, 0.2);
}

TEST(Stuffing, BudgetIsObeyedAndNamed) {
  DiagnosticSink sink;
  EXPECT_FALSE(stuffed(gyroid(), {{0, 0, 0}, {1, 1, 1}}, 0.01, {.max_memory_bytes = 1 << 20}, &sink));
  ASSERT_EQ(sink.error_count(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::limit_grid_memory);
}

TEST(Stuffing, StopsWhenAsked) {
  DiagnosticSink sink;
  EXPECT_FALSE(stuffed(gyroid(), {{0, 0, 0}, {1, 1, 1}}, 0.02, {.cancelled = [] { return true; }}, &sink));
  ASSERT_EQ(sink.error_count(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::cancelled);
}

}  // namespace
}  // namespace meso::implicit
