// SPDX-License-Identifier: Apache-2.0
// Edges and corners that are known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "function_source_for_test.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/mesh/audit_mesh.hpp"

namespace meso::implicit {
namespace {

using Function = FunctionSource::Function;

constexpr double pi = std::numbers::pi;

Grid cube(std::int32_t n, double half = 1) { return {{{-half, -half, -half}, {half, half, half}}, {n, n, n}}; }

TriangleMesh sharp_mesh(const Grid& grid, const Function& f, const RunOptions& run = {}, bool signs_only = false) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  DiagnosticSink diagnostics;
  EXPECT_TRUE(contour(FunctionSource(grid, f, signs_only), sink, {.sharp = true}, run, diagnostics));
  EXPECT_TRUE(diagnostics.diagnostics().empty());
  return mesh;
}

TriangleMesh plain_mesh(const Grid& grid, const Function& f) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  DiagnosticSink diagnostics;
  EXPECT_TRUE(contour(FunctionSource(grid, f), sink, {.polish = true}, {}, diagnostics));
  return mesh;
}

MeshAudit expect_closed(const TriangleMesh& mesh) {
  const MeshAudit audit = audit_mesh(mesh);
  EXPECT_TRUE(audit.watertight());
  std::vector<bool> used(mesh.points.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t) used[corner] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  return audit;
}

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(p - a - t * (b - a));
}

/// The largest distance of points from edges of the mesh; only edges near a point are looked at, so it is an upper
/// bound.
class EdgesOf {
 public:
  EdgesOf(const TriangleMesh& mesh, double cell) : mesh_(mesh), cell_(cell), bins_(1 << 16) {
    for (const auto& t : mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        if (a > b) continue;
        const Vec3 middle = (mesh.points[a] + mesh.points[b]) / 2;
        bins_[bin(middle, {0, 0, 0})].push_back({a, b});
      }
  }
  [[nodiscard]] double distance(Vec3 p) const {
    double least = HUGE_VAL;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          for (const auto& [a, b] : bins_[bin(p, {double(x), double(y), double(z)})])
            least = std::min(least, distance_to_segment(p, mesh_.points[a], mesh_.points[b]));
    return least;
  }

 private:
  [[nodiscard]] std::size_t bin(Vec3 p, Vec3 shift) const {
    std::uint64_t h = 0;
    for (std::size_t i = 0; i < 3; ++i)
      h = h * 1000003 + static_cast<std::uint64_t>(std::floor(p[i] / cell_) + shift[i] + 100000);
    return h % bins_.size();
  }
  const TriangleMesh& mesh_;
  double cell_;
  std::vector<std::vector<std::array<std::uint32_t, 2>>> bins_;
};

/// Triangles that look the other way than the surface below their middle does.
std::size_t flipped(const TriangleMesh& mesh, const Function& f, double h) {
  std::size_t count = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const Vec3 normal = cross(b - a, c - a), middle = (a + b + c) / 3;
    if (norm(normal) < 1e-9 * h * h) continue;
    Vec3 slope;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 after = middle;
      after[axis] += 1e-6 * h;
      slope[axis] = f(after) - f(middle);
    }
    count += dot(normal, slope) < 0 ? 1 : 0;
  }
  return count;
}

const Mat3 turn = rotation(Vec3{1, 2, 3} / std::sqrt(14), 0.6);
const Vec3 half_sides{0.6, 0.5, 0.4};
constexpr double hole = 0.25;

Vec3 into_box(Vec3 p) { return transposed(turn) * p; }

double box(Vec3 p) {
  const Vec3 q = into_box(p);
  return std::max({std::fabs(q.x) - half_sides.x, std::fabs(q.y) - half_sides.y, std::fabs(q.z) - half_sides.z});
}
double drilled_box(Vec3 p) {
  const Vec3 q = into_box(p);
  return std::max(box(p), hole - std::hypot(q.x, q.y));
}

std::vector<Vec3> points_on_edges_of_the_box() {
  std::vector<Vec3> points;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner)
      for (int step = 0; step <= 400; ++step) {
        Vec3 q;
        q[axis] = half_sides[axis] * (step - 200) / 200;
        q[(axis + 1) % 3] = half_sides[(axis + 1) % 3] * (corner & 1 ? 1 : -1);
        q[(axis + 2) % 3] = half_sides[(axis + 2) % 3] * (corner & 2 ? 1 : -1);
        points.push_back(turn * q);
      }
  return points;
}

TEST(Sharp, KeepsTheEdgesOfARotatedBox) {
  for (const std::int32_t n : {50, 100}) {
    const double h = 2.0 / (n - 1);
    const TriangleMesh mesh = sharp_mesh(cube(n), box);
    const MeshAudit audit = expect_closed(mesh);
    EXPECT_NEAR(audit.volume, 8 * half_sides.x * half_sides.y * half_sides.z, 1e-9);
    const EdgesOf edges(mesh, 3 * h);
    double worst = 0;
    for (const Vec3& p : points_on_edges_of_the_box()) worst = std::max(worst, edges.distance(p));
    EXPECT_LT(worst, 1e-6 * h);
    EXPECT_EQ(flipped(mesh, box, h), 0u);
  }
}

TEST(Sharp, DrillsABox) {
  const std::int32_t n = 100;
  const double h = 2.0 / (n - 1);
  const TriangleMesh mesh = sharp_mesh(cube(n), drilled_box);
  const MeshAudit audit = expect_closed(mesh);
  EXPECT_NEAR(audit.volume, 8 * half_sides.x * half_sides.y * half_sides.z - 2 * half_sides.z * pi * hole * hole, 1e-3);
  const EdgesOf edges(mesh, 3 * h);
  double worst = 0;
  for (const Vec3& p : points_on_edges_of_the_box()) worst = std::max(worst, edges.distance(p));
  EXPECT_LT(worst, 1e-6 * h);
  // Vertices beside a rim stand on it, and its chords are the only error.
  std::size_t on_rim = 0;
  for (const Vec3& p : mesh.points) {
    const Vec3 q = into_box(p);
    const double off = std::hypot(std::hypot(q.x, q.y) - hole, std::fabs(q.z) - half_sides.z);
    if (off < 1e-6 * h) ++on_rim;
  }
  EXPECT_GT(on_rim, 2 * 2 * pi * hole / h / 2);
  double worst_on_rim = 0;
  for (int step = 0; step < 1000; ++step)
    for (const double z : {-half_sides.z, half_sides.z}) {
      const double angle = 2 * pi * step / 1000;
      const Vec3 p = turn * Vec3{hole * std::cos(angle), hole * std::sin(angle), z};
      worst_on_rim = std::max(worst_on_rim, edges.distance(p));
    }
  EXPECT_LT(worst_on_rim, 2 * h * h / (8 * hole) * 3);
  EXPECT_EQ(flipped(mesh, drilled_box, h), 0u);
}

double gyroid(Vec3 p) {
  const double t = 2 * pi;
  return std::cos(t * p.x) * std::sin(t * p.y) + std::cos(t * p.y) * std::sin(t * p.z) +
         std::cos(t * p.z) * std::sin(t * p.x);
}

TEST(Sharp, ClipsAGyroid) {
  const auto clipped = [](Vec3 p) { return std::max(gyroid(p), box(p)); };
  const std::int32_t n = 80;
  const double h = 2.0 / (n - 1);
  const TriangleMesh mesh = sharp_mesh(cube(n), clipped);
  expect_closed(mesh);
  const auto on_both = [&](Vec3 p) { return std::fabs(gyroid(p)) < 1e-4 * h && std::fabs(box(p)) < 1e-5 * h; };
  std::size_t on_edges = 0, off = 0;
  double length = 0;
  for (const Vec3& p : mesh.points) {
    if (std::fabs(clipped(p)) > 1e-4 * h) ++off;
    if (on_both(p)) ++on_edges;
  }
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = mesh.points[t[i]], b = mesh.points[t[(i + 1) % 3]];
      if (t[i] < t[(i + 1) % 3] && on_both(a) && on_both(b)) length += norm(b - a);
    }
  // The lines in which the gyroid meets the box, counted by crossings with a fine grid of lines in the six sides
  // (Cauchy and Crofton): length = pi / 4 * crossings * spacing for both directions together.
  double expected = 0;
  const int lines = 400;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto value = [&](int i, int j) {
        Vec3 q;
        q[axis] = side * half_sides[axis];
        q[u] = half_sides[u] * (2 * (i + 0.5) / lines - 1);
        q[v] = half_sides[v] * (2 * (j + 0.5) / lines - 1);
        return gyroid(turn * q) < 0;
      };
      for (int i = 1; i < lines; ++i)
        for (int j = 1; j < lines; ++j) {
          if (value(i, j) != value(i - 1, j)) expected += pi / 4 * 2 * half_sides[v] / lines;
          if (value(i, j) != value(i, j - 1)) expected += pi / 4 * 2 * half_sides[u] / lines;
        }
    }
  const TriangleMesh plain = plain_mesh(cube(n), clipped);
  EXPECT_LT(flipped(mesh, clipped, h), flipped(plain, clipped, h));  // both: beside wedges thinner than a cell
  EXPECT_GT(on_edges, expected / h / 2);
  // Missing: where the two meet at less than 25 degrees, and wedges thinner than a cell; as many as there are cells.
  EXPECT_NEAR(length, expected, 6.5 * h * expected);
  EXPECT_LE(off, 2u);  // in the middle of cells with joined faces
}

TEST(Sharp, LeavesRoundThingsAlone) {
  // Five samples across: normals of a cell's corners spread by more than an edge's would have to.
  const auto ball = [](Vec3 p) { return norm(p) - 0.62; };
  const Grid grid = cube(8);
  EXPECT_EQ(sharp_mesh(grid, ball).triangles, plain_mesh(grid, ball).triangles);
}

TEST(Sharp, IsClosedWhateverTheFieldIs) {
  EXPECT_GT(expect_closed(sharp_mesh(cube(40), noise)).triangles, 100000u);
  // Signs of nodes at random, straight in between with a fold: features everywhere, joined faces, the box's sides.
  const auto folded = [](Vec3 p) {
    const Vec3 cell{std::round(p.x * 8) / 8, std::round(p.y * 8) / 8, std::round(p.z * 8) / 8}, d = p - cell;
    return std::copysign(0.07 - std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}), noise(cell));
  };
  EXPECT_GT(expect_closed(sharp_mesh(cube(17), folded)).triangles, 10000u);
  const auto crossing_plates = [](Vec3 p) {
    return std::min({std::fabs(p.x + 0.3 * p.y) - 0.1, std::fabs(p.y - 0.2 * p.z) - 0.1, std::fabs(p.z + p.x) - 0.1});
  };
  expect_closed(sharp_mesh(cube(33), crossing_plates));
}

/// What the shells of a mesh enclose, one by one.
std::vector<double> volumes_of_shells(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const auto& t : mesh.triangles) parent[root(t[1])] = root(t[0]), parent[root(t[2])] = root(t[0]);
  std::vector<double> enclosed(mesh.points.size(), 0);
  std::vector<char> is_root(mesh.points.size(), 0);
  for (const auto& t : mesh.triangles) {
    const std::uint32_t r = root(t[0]);
    is_root[r] = 1;
    // Seen from the shell itself: small ones far from the origin would drown in rounding.
    const Vec3 eye = mesh.points[r];
    enclosed[r] += dot(mesh.points[t[0]] - eye, cross(mesh.points[t[1]] - eye, mesh.points[t[2]] - eye)) / 6;
  }
  std::vector<double> result;
  for (std::size_t p = 0; p < enclosed.size(); ++p)
    if (is_root[p] != 0) result.push_back(enclosed[p]);
  return result;
}

/// Triangles that face inward by the field at all of their corners and in their middle.
std::size_t turned(const TriangleMesh& mesh, const Function& f, double h) {
  std::size_t count = 0;
  const auto slope_at = [&](Vec3 p) {
    Vec3 slope;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 before = p, after = p;
      before[axis] -= 1e-6 * h, after[axis] += 1e-6 * h;
      slope[axis] = f(after) - f(before);
    }
    return slope;
  };
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const Vec3 normal = cross(b - a, c - a);
    bool inward = true;
    for (const Vec3& p : {a, b, c, (a + b + c) / 3}) inward = inward && dot(normal, slope_at(p)) < 0;
    count += inward ? 1 : 0;
  }
  return count;
}

// A shell that is thinner than a cell, of a lattice that is not much thicker, is seen as crumbs: each of them has its
// inside inside all the same.
TEST(Sharp, TurnsNoCrumbInsideOut) {
  const auto crumbs = [](Vec3 p) {
    const double r = norm(p);
    return std::max({r - 1, 0.98 - r, gyroid(p / 0.4)});
  };
  for (const std::int32_t n : {30, 40, 60, 75}) {
    const double h = 2.0 / (n - 1);
    const TriangleMesh mesh = sharp_mesh(cube(n), crumbs);
    expect_closed(mesh);
    const std::vector<double> volumes = volumes_of_shells(mesh);
    EXPECT_GT(volumes.size(), 100u) << n;
    EXPECT_EQ(std::count_if(volumes.begin(), volumes.end(), [](double v) { return v <= 0; }), 0) << n;
    // What marching cubes turn by themselves is there in both. Between two bricks, one triangle may be left.
    EXPECT_LE(turned(mesh, crumbs, h), turned(plain_mesh(cube(n), crumbs), crumbs, h) + 1) << n;
  }
}

TEST(Sharp, TurnsNoTriangleOfASheetCutByTheBox) {
  // Walls that grow from half a cell to two.
  const auto sheet = [](Vec3 p) { return std::max(std::fabs(gyroid(p)) - 0.3 - 0.25 * p.z, box(p)); };
  for (const std::int32_t n : {30, 45}) {
    const double h = 2.0 / (n - 1);
    const TriangleMesh mesh = sharp_mesh(cube(n), sheet);
    expect_closed(mesh);
    EXPECT_LE(turned(mesh, sheet, h), turned(plain_mesh(cube(n), sheet), sheet, h)) << n;
  }
}

TEST(Sharp, IsTheSameForAnyNumberOfThreads) {
  const Grid grid{{{-1, -1, -1}, {1, 1, 1}}, {40, 45, 70}};
  const TriangleMesh one = sharp_mesh(grid, drilled_box, {.jobs = 1}),
                     four = sharp_mesh(grid, drilled_box, {.jobs = 4});
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.triangles, four.triangles);
}

TEST(Sharp, TakesFieldsOfDearValues) {
  const Grid grid = cube(40);
  const TriangleMesh asked = sharp_mesh(grid, drilled_box, {}, true);
  expect_closed(asked);
  EXPECT_EQ(asked.triangles, sharp_mesh(grid, drilled_box).triangles);
}

}  // namespace
}  // namespace meso::implicit
