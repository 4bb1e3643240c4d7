// SPDX-License-Identifier: Apache-2.0
// A mesh on grids: rows against single values, in every position, band and number of threads.
#include "prepared_mesh.hpp"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <numbers>

#include "meso/mesh_distance/mesh_field.hpp"
#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

std::shared_ptr<const MeshField> field_of(const TriangleMesh& mesh) {
  DiagnosticSink sink;
  return MeshField::make(mesh, "mesh", {}, sink);
}

std::vector<double> all_rows(const MeshField& field, const Grid& grid, const Affine& map, double band) {
  std::vector<double> out(grid.node_count());
  const auto prepared = field.prepare(grid, map, band, {});
  const auto rows = prepared->make_rows();
  double* at = out.data();
  for (std::int32_t k = 0; k < grid.nodes[2]; ++k) {
    for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
      const std::int32_t half = grid.nodes[0] / 3;  // in two pieces
      rows->row(j, k, half, grid.nodes[0], at + half);
      rows->row(j, k, 0, half, at);
      at += grid.nodes[0];
    }
  }
  return out;
}

template <class Visit>
void visit_nodes(const Grid& grid, Visit visit) {
  std::size_t n = 0;
  for (std::int32_t k = 0; k < grid.nodes[2]; ++k) {
    for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
      for (std::int32_t i = 0; i < grid.nodes[0]; ++i) visit(n++, grid.node(i, j, k));
    }
  }
}

int sign(double x) { return (x > 0) - (x < 0); }

/// `exact_signs`: the map keeps the bits of single values.
void expect_rows_like_values(const MeshField& field, const Grid& grid, const Affine& map, bool exact_signs) {
  const std::vector<double> exact = all_rows(field, grid, map, HUGE_VAL), signs = all_rows(field, grid, map, 0);
  constexpr double width = 0.13;
  const std::vector<double> band = all_rows(field, grid, map, width);
  visit_nodes(grid, [&](std::size_t n, Vec3 p) {
    const double value = field.value(map * p);
    if (exact_signs)
      ASSERT_EQ(exact[n], value);
    else
      ASSERT_NEAR(exact[n], value, 1e-13);
    ASSERT_EQ(sign(signs[n]), sign(exact[n]));
    ASSERT_EQ(sign(band[n]), sign(exact[n]));
    if (std::abs(exact[n]) <= width) {
      ASSERT_EQ(band[n], exact[n]);
    } else {
      ASSERT_GT(std::abs(band[n]), width);
    }
  });
}

const Grid grid{.box = {{-1.25, -1.25, -1.25}, {1.25, 1.25, 1.5}}, .nodes = {41, 33, 23}};

/// Points with neighbours in the list near and far, nodes among them, asked within all kinds of magnitudes.
void expect_points_like_values(const MeshField& field, const Affine& map, bool exact_signs) {
  Random random(41);
  std::vector<Vec3> points;
  std::vector<double> within;
  for (std::int32_t k = 0; k < grid.nodes[2]; k += 3)
    for (std::int32_t j = 0; j < grid.nodes[1]; j += 2)
      for (std::int32_t i = 0; i < grid.nodes[0]; ++i) points.push_back(grid.node(i, j, k));
  for (Vec3 p; points.size() < 12'000; points.push_back(p))
    p = random.in(0, 1) < 0.1 ? random.in_cube(1.4) : p + std::exp(random.in(-12, -2)) * random.in_cube(1);
  for (std::size_t n = 0; n < points.size(); ++n)
    within.push_back(n % 17 == 0 ? HUGE_VAL : n % 5 == 0 ? 0 : std::exp(random.in(-6, 0)));
  std::vector<double> found(points.size());
  field.prepare(grid, map, 0, {})->make_rows()->values_at(points, within, found.data());
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double value = field.value(map * points[n]);
    if (!exact_signs && std::abs(value) < 1e-13) continue;
    ASSERT_EQ(sign(found[n]), sign(value)) << n;
    if (std::abs(value) <= within[n]) {
      ASSERT_EQ(found[n], value) << n;
    } else {
      ASSERT_TRUE(std::abs(found[n]) > within[n] || (within[n] == 0 && found[n] != 0)) << n;
    }
  }
}

TEST(PreparedMesh, RowsAreValuesWhereTheMapScalesShiftsAndMirrors) {
  for (const TriangleMesh& mesh : {icosphere(2), spiky_saddle(7), box_mesh({-1, -1, -1}, {1, 1, 1})}) {
    const auto field = field_of(mesh);
    expect_rows_like_values(*field, grid, {}, true);
    expect_points_like_values(*field, {}, true);
    expect_points_like_values(*field, {{{-1, 0, 0, 0, 0.7, 0, 0, 0, -1.3}}, {0.1, 0.3, -0.2}}, true);
    expect_points_like_values(*field, {rotation({0.6, 0, 0.8}, 1), {0.1, 0.05, -0.1}}, false);
    expect_rows_like_values(*field, grid, Affine::from_translation({0.1, -0.2, 1e-3}), true);
    expect_rows_like_values(*field, grid, {{{-1, 0, 0, 0, 0.7, 0, 0, 0, -1.3}}, {0.1, 0.3, -0.2}}, true);
  }
}

TEST(PreparedMesh, WithinTwoCellsRowsAreTheDistanceToTheNearestOfAllTriangles) {
  const TriangleMesh mesh = spiky_saddle(9);
  const double two_cells = 2 * grid.spacing(0);
  const std::vector<double> rows = all_rows(*field_of(mesh), grid, {}, two_cells);
  std::size_t near = 0;
  visit_nodes(grid, [&](std::size_t n, Vec3 p) {
    const double exact = static_cast<double>(slow_distance(mesh, p));
    if (exact > 1e-12) {
      ASSERT_EQ(rows[n]<0, solid_angle_winding(mesh, p)> 0.5);
    }
    if (exact < two_cells) {
      ASSERT_NEAR(std::abs(rows[n]), exact, 1e-15);
    }
    near += exact < two_cells ? 1 : 0;
  });
  EXPECT_GT(near, 800u);
}

TEST(PreparedMesh, IsNotPreparedForWhoStopped) {
  const auto field = field_of(icosphere(4));
  for (const bool open : {false, true}) {
    TriangleMesh mesh = icosphere(4);
    if (open) mesh.triangles.resize(mesh.triangles.size() / 2);
    DiagnosticSink sink;
    const auto broken = MeshField::make(mesh, "mesh", {}, sink);
    EXPECT_EQ(broken->prepare(grid, {}, 0.1, {.cancelled = [] { return true; }}), nullptr);
    int polls = 0;
    const auto later = broken->prepare(grid, {}, 0.1, {.cancelled = [&] { return ++polls > 2; }});
    EXPECT_TRUE(polls < 3 || later == nullptr);
    EXPECT_GT(broken->bytes(), mesh.triangles.size() * 72);
    EXPECT_GT(broken->prepared_bytes(grid), open ? grid.node_count() / 4 : 0);
  }
}

TEST(PreparedMesh, RowsAreValuesUnderAnyMap) {
  const Affine turned{rotation({0.6, 0, 0.8}, 1), {0.1, 0.05, -0.1}};
  const Affine sheared{{{1, 0.3, -0.2, 0.1, -0.8, 0.25, 0, 0.4, 1.1}}, {0, 0.1, 0}};
  const Affine axes_exchanged{{{0, 1, 0, 0, 0, 1, 1, 0, 0}}, {}};
  for (const TriangleMesh& mesh : {icosphere(2), spiky_saddle(7)}) {
    const auto field = field_of(mesh);
    for (const Affine& map : {turned, sheared, axes_exchanged}) expect_rows_like_values(*field, grid, map, false);
  }
}

TEST(PreparedMesh, NodesOnTheSurfaceAreZeroInEveryBand) {
  // The box's faces, edges and corners are nodes; so are points of the faces of the octahedron.
  const TriangleMesh octahedron{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  const Grid nodes{.box = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}, .nodes = {25, 25, 25}};
  for (const bool box : {false, true}) {
    const auto field = field_of(box ? box_mesh({-1, -1, -1}, {1, 1, 1}) : octahedron);
    for (const double band : {0.0, 0.2, HUGE_VAL}) {
      const std::vector<double> rows = all_rows(*field, nodes, {}, band);
      std::size_t zeros = 0;
      visit_nodes(nodes, [&](std::size_t n, Vec3 p) {
        const double sum = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
        const double f = box ? std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 1 : sum - 1;
        ASSERT_EQ(sign(rows[n]), sign(f)) << p.x << " " << p.y << " " << p.z;
        zeros += f == 0 ? 1 : 0;
      });
      EXPECT_EQ(zeros, box ? 17u * 17 * 17 - 15u * 15 * 15 : 4u * 8 * 8 + 2);
    }
  }
}

TEST(PreparedMesh, NodesOnBuriedWallsAreInside) {
  // Walls, edges and corners of two boxes in each other, all of them nodes; and a third that only touches.
  const std::array<std::pair<Vec3, Vec3>, 3> boxes{
      {{{-1, -1, -1}, {0.5, 0.5, 0.5}}, {{-0.25, -0.5, -0.25}, {1, 1, 1}}, {{-1, 0.5, -1}, {-0.5, 1, 1}}}};
  TriangleMesh mesh;
  for (const auto& [low, high] : boxes) mesh = together(mesh, box_mesh(low, high));
  const auto field = field_of(mesh);
  const Grid nodes{.box = {{-1.25, -1.25, -1.25}, {1.25, 1.25, 1.25}}, .nodes = {21, 21, 21}};
  for (const double band : {0.0, 0.2, HUGE_VAL}) {
    const std::vector<double> rows = all_rows(*field, nodes, {}, band);
    int walls = 0;
    visit_nodes(nodes, [&](std::size_t n, Vec3 p) {
      double exact = HUGE_VAL, wall = HUGE_VAL;
      for (const auto& [low, high] : boxes) {
        exact = std::min(exact, box_distance(low, high, p));
        wall = std::min(wall, std::abs(box_distance(low, high, p)));
      }
      if (exact != 0) {
        ASSERT_EQ(sign(rows[n]), sign(exact)) << p.x << " " << p.y << " " << p.z;
      }
      ASSERT_EQ(sign(rows[n]), sign(field->value(p)));
      walls += exact < 0 && wall == 0 ? 1 : 0;
    });
    EXPECT_GT(walls, 100);
  }
}

TEST(PreparedMesh, OpenMeshesHaveTheSignsOfTheirWindingNumber) {
  TriangleMesh bowl = icosphere(3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.points[t[0]].z + 0.3 * bowl.points[t[1]].x > 0.3; });
  DiagnosticSink sink;
  const auto field = MeshField::make(bowl, "bowl", {}, sink);
  for (const Affine& map : {Affine{}, Affine{rotation({0, 1, 0}, 0.4), {}}}) {
    const std::vector<double> rows = all_rows(*field, grid, map, 0);
    std::size_t inside = 0;
    visit_nodes(grid, [&](std::size_t n, Vec3 p) {
      ASSERT_EQ(rows[n] < 0, field->value(map * p) < 0);
      inside += rows[n] < 0 ? 1 : 0;
    });
    EXPECT_GT(inside, 1000u);
  }
  // A grid that lies wholly inside.
  const Grid within{.box = {{-0.1, -0.1, -0.8}, {0.1, 0.1, -0.6}}, .nodes = {5, 5, 5}};
  for (const double v : all_rows(*field, within, {}, 0)) EXPECT_LT(v, 0);
}

TEST(PreparedMesh, SameBitsForEveryNumberOfThreads) {
  const TriangleMesh mesh = icosphere(5);  // large enough to be built in parallel
  const auto rows_with = [&](unsigned jobs) {
    DiagnosticSink sink;
    const auto field = MeshField::make(mesh, "mesh", {.jobs = jobs}, sink);
    std::vector<double> out;
    tbb::task_arena arena(jobs == 1 ? 1 : tbb::task_arena::automatic);
    arena.execute([&] { out = all_rows(*field, grid, {rotation({1, 0, 0}, 0.3), {}}, 0.2); });
    return out;
  };
  const std::vector<double> one = rows_with(1);
  EXPECT_EQ(one, rows_with(2));
  EXPECT_EQ(one, rows_with(7));
}

TEST(PreparedMesh, SignsOfATorus) {
  // Around a hole, in shuffled order, with triangles far smaller than a cell.
  TriangleMesh mesh;
  constexpr std::uint32_t around = 200, across = 100;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across,
                   r = 0.7 + 0.25 * std::cos(v);
      mesh.points.push_back({r * std::cos(u), r * std::sin(u), 0.25 * std::sin(v)});
      const auto at = [](std::uint32_t a, std::uint32_t b) { return a % around * across + b % across; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const double sagitta = 0.95 * (1 - std::cos(std::numbers::pi / across)) + (1 - std::cos(std::numbers::pi / around));
  const auto field = field_of(mesh);
  const std::vector<double> rows = all_rows(*field, grid, {}, 0.1);
  visit_nodes(grid, [&](std::size_t n, Vec3 p) {
    const double exact = std::hypot(std::hypot(p.x, p.y) - 0.7, p.z) - 0.25;
    if (std::abs(exact) > sagitta) {
      ASSERT_EQ(sign(rows[n]), sign(exact));
    }
    if (std::abs(rows[n]) < 0.1) {
      ASSERT_NEAR(rows[n], exact, sagitta);
    }
  });
}

}  // namespace
}  // namespace meso::implicit
