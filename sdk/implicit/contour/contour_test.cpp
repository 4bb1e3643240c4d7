// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/contour.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>

#include "function_source_for_test.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/mesh/audit_mesh.hpp"

namespace meso::implicit {
namespace {

using Function = FunctionSource::Function;

constexpr double pi = std::numbers::pi;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

double gyroid(Vec3 p) {
  const double t = 2 * pi;
  return std::cos(t * p.x) * std::sin(t * p.y) + std::cos(t * p.y) * std::sin(t * p.z) +
         std::cos(t * p.z) * std::sin(t * p.x);
}

double ball(Vec3 p) { return norm(p) - 1; }

Grid cube(std::int32_t n, double half = 1) { return {{{-half, -half, -half}, {half, half, half}}, {n, n, n}}; }

struct Result {
  TriangleMesh mesh;
  ContourReport report;
};

Result contour_of(const GridSource& source, const ContourOptions& options = {}, const RunOptions& run = {}) {
  Result result;
  MemoryMeshSink sink(result.mesh);
  DiagnosticSink diagnostics;
  const auto report = contour(source, sink, options, run, diagnostics);
  EXPECT_TRUE(report);
  EXPECT_TRUE(diagnostics.diagnostics().empty());
  if (report) result.report = *report;
  EXPECT_EQ(result.report.points, result.mesh.points.size());
  EXPECT_EQ(result.report.triangles, result.mesh.triangles.size());
  return result;
}

TriangleMesh mesh_of(const Grid& grid, const Function& f) { return contour_of(FunctionSource(grid, f)).mesh; }

// Closed, a manifold along edges, no triangle degenerate, every point used, and nothing outside of the box.
MeshAudit expect_sound(const TriangleMesh& mesh, const Grid& grid) {
  const MeshAudit audit = audit_mesh(mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.degenerate, 0u);
  std::vector<bool> used(mesh.points.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t) used[corner] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_GE(audit.box.min[axis], grid.box.min[axis]);
    EXPECT_LE(audit.box.max[axis], grid.box.max[axis]);
  }
  return audit;
}

MeshAudit expect_sound(const Grid& grid, const Function& f) { return expect_sound(mesh_of(grid, f), grid); }

TEST(Contour, ClosesTheGyroidAtTheBox) {
  const MeshAudit audit = expect_sound(cube(60), gyroid);
  EXPECT_NEAR(audit.volume, 4.0, 1e-3);
  EXPECT_NEAR(audit.area, 8 * 3.0916 + 12, 0.1);
}

TEST(Contour, IsAManifoldWhereTheFieldIsNoise) { EXPECT_GT(expect_sound(cube(60), noise).triangles, 500000u); }

TEST(Contour, FillsTheBoxExactly) {
  const Grid grid{{{-1, -2, 0.1}, {1, 3, 0.7}}, {5, 64, 65}};
  const MeshAudit audit = expect_sound(grid, [](Vec3) { return -1.0; });
  EXPECT_NEAR(audit.volume, 2 * 5 * 0.6, 1e-12);
  EXPECT_NEAR(audit.area, 2 * (2 * 5 + 5 * 0.6 + 0.6 * 2), 1e-12);
  EXPECT_EQ(audit.box, grid.box);
  EXPECT_EQ(audit.points, 5u * 64 * 65 - 3u * 62 * 63);  // the nodes on the box
}

TEST(Contour, TellsHowThickTheInsideIs) {
  for (const double radius : {0.41, 0.73}) {
    const auto report = contour_of(FunctionSource(cube(50), [radius](Vec3 p) { return norm(p) - radius; })).report;
    const double h = 2.0 / 49;
    EXPECT_NEAR(static_cast<double>(report.inside) * std::pow(h / radius, 3), 4.0 / 3 * std::numbers::pi, 0.05);
    EXPECT_NEAR(report.cells_thick() * h, 2 * radius / 3, 0.06 * radius);
  }
}

TEST(Contour, IsEmptyOutside) {
  const Result result = contour_of(FunctionSource(cube(7), [](Vec3) { return 0.0; }));
  EXPECT_TRUE(result.mesh.triangles.empty());
  EXPECT_EQ(result.report.euler, 0);
}

TEST(Contour, CutsTheCornerOfABox) {
  const MeshAudit audit = expect_sound(cube(101), [](Vec3 p) { return p.x + p.y + p.z - 1; });
  EXPECT_NEAR(audit.volume, 8 - 8.0 / 6, 1e-3);
}

// Every corner of the box alone, every edge, and all but each: where shared vertices fold triangles up.
TEST(Contour, SharesVerticesAlongTheBoxsEdges) {
  for (int corners = 0; corners < 256; ++corners) {
    const auto field = [&](Vec3 p) {
      double nearest = 10, sign = 1;
      for (int c = 0; c < 8; ++c) {
        const Vec3 at{c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0};
        if (norm(p - at) < nearest) nearest = norm(p - at), sign = corners >> c & 1 ? -1 : 1;
      }
      return sign;
    };
    for (const std::int32_t n : {2, 3, 5})
      if (corners > 0) expect_sound(cube(n), field);
  }
}

TEST(Contour, TakesThinGridsAndRowsOfWholeWords) {
  for (const std::array<std::int32_t, 3> nodes :
       {std::array{2, 2, 2}, {2, 40, 30}, {63, 2, 9}, {64, 17, 2}, {65, 2, 2}, {128, 16, 16}, {2, 2, 65}}) {
    const Grid grid{{{-1, -1, -1}, {1, 1, 1}}, nodes};
    expect_sound(grid, [](Vec3) { return -1.0; });
    expect_sound(grid, [](Vec3 p) { return noise(7.3 * p) - 0.3; });
  }
}

TEST(Contour, TakesNodesThatAreExactlyZeroAsOutside) {
  // The planes x = 0, y = 0 and z = 0 of nodes are zeros.
  expect_sound(cube(21), [](Vec3 p) { return std::round(p.x * 10) * std::round(p.y * 10) * std::round(p.z * 10); });
  const MeshAudit audit = expect_sound(cube(21), [](Vec3 p) { return std::max(std::fabs(p.x), std::fabs(p.y)) - 0.5; });
  EXPECT_NEAR(audit.volume, 2 * (1 - 4 * 0.1 * 0.1 / 2), 2e-3);  // a prism whose long edges are cut by half a cell
}

TEST(Contour, TakesSamplesWithoutValueAsOutside) {
  const auto half_ball = [](Vec3 p) { return p.x > 0.123 ? not_a_number : norm(p) - 0.8; };
  const Result result = contour_of(FunctionSource(cube(40), half_ball));
  const MeshAudit audit = expect_sound(result.mesh, cube(40));
  EXPECT_GT(result.report.undefined, 100u);
  const double h = 2.0 / 39;
  EXPECT_NEAR(audit.box.max.x, 0.123, h);
  for (const Vec3& p : result.mesh.points) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  for (const double extreme : {HUGE_VAL, 1e300, -1e300, -HUGE_VAL})
    expect_sound(cube(20), [&](Vec3 p) { return p.x > 0.123 ? extreme : norm(p) - 0.8; });
}

TEST(Contour, ConvergesWithTheSquareOfTheSpacing) {
  const auto errors = [](const Function& f, std::int32_t n, double half, double volume, double area) {
    const MeshAudit audit = audit_mesh(mesh_of(cube(n, half), f));
    return std::pair{std::fabs(audit.volume - volume), std::fabs(audit.area - area)};
  };
  const auto coarse = errors(ball, 33, 1.25, 4 * pi / 3, 4 * pi), fine = errors(ball, 65, 1.25, 4 * pi / 3, 4 * pi);
  EXPECT_NEAR(coarse.first / fine.first, 4, 0.4);
  EXPECT_NEAR(coarse.second / fine.second, 4, 0.4);
  EXPECT_LT(fine.first, 0.01);
  EXPECT_LT(fine.second, 0.01);
  // The gyroid's area is known to four digits only: compare the errors of three grids with each other.
  const double a20 = audit_mesh(mesh_of(cube(40), gyroid)).area, a40 = audit_mesh(mesh_of(cube(79), gyroid)).area,
               a80 = audit_mesh(mesh_of(cube(157), gyroid)).area;
  EXPECT_NEAR((a20 - a40) / (a40 - a80), 4, 0.4);
}

TEST(Contour, GivesEqualMeshesForAnyNumberOfThreads) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 7);
  for (const Function& f : {Function(gyroid), Function(noise)}) {
    const FunctionSource source(cube(48), f);
    const TriangleMesh one = contour_of(source, {}, {.jobs = 1}).mesh;
    for (const unsigned jobs : {2U, 7U}) {
      const TriangleMesh mesh = contour_of(source, {}, {.jobs = jobs}).mesh;
      EXPECT_EQ(mesh.points, one.points);
      EXPECT_EQ(mesh.triangles, one.triangles);
    }
  }
}

TEST(Contour, AsksForValuesOnlyWhereSignsDiffer) {
  for (const Function& f : {Function(gyroid), Function(noise), Function(ball)}) {
    const TriangleMesh all = contour_of(FunctionSource(cube(48), f), {}, {.jobs = 2}).mesh;
    const TriangleMesh ends = contour_of(FunctionSource(cube(48), f, true), {}, {.jobs = 2}).mesh;
    EXPECT_EQ(all.points, ends.points);
    EXPECT_EQ(all.triangles, ends.triangles);
  }
}

TEST(Contour, PolishesVerticesOntoTheField) {
  const Grid grid = cube(24);
  const TriangleMesh mesh = contour_of(FunctionSource(grid, gyroid), {.polish = true}).mesh;
  expect_sound(mesh, grid);
  const double h = grid.spacing(0), steepest = 10.88;
  for (const Vec3& p : mesh.points) {
    const bool on_box = std::fabs(p.x) == 1 || std::fabs(p.y) == 1 || std::fabs(p.z) == 1;
    EXPECT_LT(on_box ? 0 : std::fabs(gyroid(p)), 1e-6 * h * steepest);
  }
}

TEST(Contour, PolishedVerticesStayApartAsFloats) {
  // The walls of the box stand in planes of nodes, where vertices would run into each other.
  const Grid grid{.box = {{0, 0, 0}, {30, 20, 10}}, .nodes = {61, 41, 21}};
  const auto field = [](Vec3 p) {
    const double wall = std::max({std::fabs(p.x - 15) - 14, std::fabs(p.y - 10) - 9, std::fabs(p.z - 5) - 4});
    return std::max(wall, gyroid(0.25 * p));
  };
  const auto folded = [&](double step) {
    const TriangleMesh mesh = contour_of(FunctionSource(grid, field), {.polish = true, .coordinate_step = step}).mesh;
    const auto rounded = [&](std::uint32_t i) {
      const Vec3 p = mesh.points[i];
      return Vec3{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    };
    return std::ranges::count_if(mesh.triangles, [&](const auto& t) {
      return norm(cross(rounded(t[1]) - rounded(t[0]), rounded(t[2]) - rounded(t[0]))) == 0;
    });
  };
  EXPECT_GT(folded(0), 0);
  EXPECT_EQ(folded(0x1p-19), 0);
}

TEST(Contour, PolishFindsTheBorderOfTheDefined) {
  const auto half_ball = [](Vec3 p) { return p.x > 0.123 ? not_a_number : norm(p) - 0.8; };
  const Grid grid = cube(40);
  const TriangleMesh mesh = contour_of(FunctionSource(grid, half_ball), {.polish = true}).mesh;
  EXPECT_NEAR(expect_sound(mesh, grid).box.max.x, 0.123, 1e-6 * grid.spacing(0));
}

double sliver_share(const TriangleMesh& mesh, double spacing) {
  std::size_t slivers = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    slivers += norm(cross(b - a, c - a)) / longest < 0.05 * spacing ? 1 : 0;
  }
  return static_cast<double>(slivers) / static_cast<double>(mesh.triangles.size());
}

TEST(Contour, CollapsesSliversWithoutLosingAccuracy) {
  const auto cut_ball = [](Vec3 p) { return std::max(norm(p) - 1, p.x - 0.4); };  // with a sharp edge
  for (const auto& [f, half] : {std::pair{Function(gyroid), 1.0},
                                {Function(ball), 1.25},
                                {Function(ball), 0.8},
                                {Function(cut_ball), 1.25},
                                {Function(noise), 1.0}}) {
    const Grid grid = cube(50, half);
    const Result plain = contour_of(FunctionSource(grid, f));
    const Result collapsed = contour_of(FunctionSource(grid, f), {.collapse_slivers = true});
    const MeshAudit before = expect_sound(plain.mesh, grid), after = expect_sound(collapsed.mesh, grid);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(collapsed.report.euler, plain.report.euler);
    EXPECT_EQ(collapsed.report.euler,
              static_cast<std::int64_t>(after.points) - static_cast<std::int64_t>(after.triangles / 2));
    EXPECT_NEAR(after.volume, before.volume, 1e-3 * before.volume);
    EXPECT_EQ(after.box, before.box);
    if (before.triangles > 200000) continue;  // noise has no shape to keep
    EXPECT_LT(sliver_share(collapsed.mesh, grid.spacing(0)), 0.2 * sliver_share(plain.mesh, grid.spacing(0)));
    EXPECT_LT(after.triangles, 0.9 * static_cast<double>(before.triangles));
  }
}

TEST(Contour, CountsHandles) {
  const auto torus = [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 0.6, p.z) - 0.25; };
  EXPECT_EQ(contour_of(FunctionSource(cube(40), torus)).report.euler, 0);
  EXPECT_EQ(contour_of(FunctionSource(cube(40, 1.25), ball)).report.euler, 2);
}

TEST(Contour, StopsWhenCancelled) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  DiagnosticSink diagnostics;
  RunOptions run;
  run.cancelled = [] { return true; };
  EXPECT_FALSE(contour(FunctionSource(cube(60), gyroid), sink, {}, run, diagnostics));
  EXPECT_EQ(diagnostics.diagnostics().at(0).code, Code::cancelled);
}

TEST(Contour, StopsWithinHalfASecondAlsoWhereValuesAreDear) {
  const auto slow_ball = [](Vec3 p) {
    double v = norm(p) - 0.9;
    for (int i = 0; i < 500; ++i) v += 1e-300 * std::sin(i);
    return v;
  };
  for (const bool signs_only : {false, true}) {
    TriangleMesh mesh;
    MemoryMeshSink sink(mesh);
    DiagnosticSink diagnostics;
    RunOptions run;
    const auto start = std::chrono::steady_clock::now();
    run.deadline = start + std::chrono::milliseconds(100);
    EXPECT_FALSE(contour(FunctionSource(cube(200), slow_ball, signs_only), sink, {}, run, diagnostics));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1600));  // of a busy machine
    EXPECT_EQ(diagnostics.diagnostics().at(0).code, Code::limit_time);
  }
}

TEST(Contour, TakesExactSamplesAtEdgeEndsAndAsksForTheOthers) {
  std::size_t asked = 0;
  std::vector<std::string> meshes;
  for (const double exact_within : {0.0, 0.01, HUGE_VAL}) {
    const FunctionSource source(cube(60), gyroid, true, exact_within);
    const TriangleMesh mesh = contour_of(source, {}, {.jobs = 1}).mesh;
    std::string bytes;
    for (const Vec3& p : mesh.points) bytes.append(reinterpret_cast<const char*>(&p), sizeof p);
    meshes.push_back(bytes);
    EXPECT_EQ(source.asked() == 0, exact_within == HUGE_VAL);
    if (exact_within == 0.01) {
      EXPECT_LT(source.asked(), asked);
    }
    asked = source.asked();
  }
  EXPECT_EQ(meshes[0], meshes[1]);
  EXPECT_EQ(meshes[0], meshes[2]);
}

TEST(Contour, StopsAtTheDeadline) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  DiagnosticSink diagnostics;
  RunOptions run;
  run.deadline = std::chrono::steady_clock::now();
  EXPECT_FALSE(contour(FunctionSource(cube(60), gyroid), sink, {}, run, diagnostics));
  EXPECT_EQ(diagnostics.diagnostics().at(0).code, Code::limit_time);
}

TEST(Contour, ReportsProgressInOrder) {
  std::vector<double> fractions;
  RunOptions run;
  run.progress = [&](std::string_view stage, double fraction) {
    fractions.push_back(stage == "vertices" ? fraction : 1 + fraction);
  };
  contour_of(FunctionSource(cube(100), gyroid), {}, run);
  EXPECT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

// A sink that fails after some bytes, or numbers few points.
class WeakSink final : public MeshSink {
 public:
  WeakSink(std::uint64_t bytes, std::uint64_t points) : bytes_(bytes), points_(points) {}

  [[nodiscard]] bool begin() override { return true; }
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override {
    (void)fill(24 * block.size(), out);
  }
  [[nodiscard]] bool write_points(std::string_view bytes) override { return take(bytes); }
  [[nodiscard]] bool begin_triangles(std::uint64_t) override { return true; }
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override {
    (void)fill(12 * block.size(), out);
  }
  [[nodiscard]] bool write_triangles(std::string_view bytes) override { return take(bytes); }
  [[nodiscard]] bool finish(std::uint64_t) override { return true; }
  [[nodiscard]] std::uint64_t max_points() const override { return points_; }

 private:
  static bool fill(std::size_t bytes, ByteBuffer& out) {
    out.append(std::string(bytes, 'x'));
    return true;
  }
  bool take(std::string_view bytes) {
    EXPECT_GT(bytes_, 0u) << "called again after it failed";
    bytes_ -= std::min<std::uint64_t>(bytes_, bytes.size());
    return bytes_ > 0;
  }

  std::uint64_t bytes_, points_;
};

TEST(Contour, EndsWithoutAWordWhereTheSinkFails) {
  for (const std::uint64_t bytes : {1u, 100000u, 1000000u}) {
    WeakSink sink(bytes, 1000000);
    DiagnosticSink diagnostics;
    EXPECT_FALSE(contour(FunctionSource(cube(48), noise), sink, {}, {}, diagnostics)) << bytes;
    EXPECT_TRUE(diagnostics.diagnostics().empty());
  }
}

TEST(Contour, RefusesMoreVerticesThanTheMeshCanNumber) {
  WeakSink sink(1u << 30, 1000);
  DiagnosticSink diagnostics;
  EXPECT_FALSE(contour(FunctionSource(cube(40), gyroid), sink, {}, {}, diagnostics));
  EXPECT_EQ(diagnostics.diagnostics().at(0).code, Code::limit_vertices);
}

TEST(Contour, RefusesGridsThatExceedTheBudget) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  RunOptions run;
  DiagnosticSink before, later, after, axis;
  run.max_memory_bytes = 1u << 20;
  EXPECT_FALSE(contour(FunctionSource(cube(1000), ball), sink, {}, run, before));
  EXPECT_EQ(before.diagnostics().at(0).code, Code::limit_grid_memory);
  EXPECT_EQ(before.diagnostics().at(0).args.at(0), "1000 x 1000 x 1000");
  EXPECT_FALSE(contour(FunctionSource(cube(60), noise), sink, {}, run, later));  // its record
  EXPECT_EQ(later.diagnostics().at(0).code, Code::limit_grid_memory);
  EXPECT_FALSE(contour(FunctionSource(cube(60), gyroid), sink, {}, run, after));  // the mesh in memory
  EXPECT_EQ(after.diagnostics().at(0).code, Code::limit_grid_memory);
  EXPECT_FALSE(contour(FunctionSource({{{0, 0, 0}, {1, 1, 1}}, {65535, 2, 2}}, ball), sink, {}, {}, axis));
  EXPECT_EQ(axis.diagnostics().at(0).code, Code::limit_grid);
}

TEST(Contour, BricksThatMayNotHoldMuchWaitForTheirTurn) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
  const FunctionSource source(cube(100), noise);
  const TriangleMesh one = contour_of(source, {}, {.jobs = 1}).mesh;
  // Of four threads each may hold 5 MiB; a brick has 16.
  const TriangleMesh four = contour_of(source, {}, {.jobs = 4, .max_memory_bytes = std::uint64_t{160} << 20}).mesh;
  EXPECT_EQ(four.points, one.points);
  EXPECT_EQ(four.triangles, one.triangles);
}

TEST(Contour, ChecksAGridBeforeAFieldIsThere) {
  DiagnosticSink good, memory, nodes;
  EXPECT_TRUE(check_grid(cube(100), {}, good));
  EXPECT_FALSE(check_grid(cube(40000), {.max_memory_bytes = 1u << 26}, memory));
  EXPECT_EQ(memory.diagnostics().at(0).code, Code::limit_grid_memory);
  EXPECT_FALSE(check_grid({{{0, 0, 0}, {1, 1, 1}}, {2, 1 << 25, 2}}, {}, nodes));
  EXPECT_EQ(nodes.diagnostics().at(0).code, Code::limit_grid);
}

// Memory may run out in one thread while the others wait for its brick.
TEST(Contour, EndsWhenAThreadThrows) {
  const FunctionSource source({.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {20, 20, 200}}, [](Vec3 p) {
    if (p.z < -0.95) throw std::bad_alloc();
    return std::sin(40 * p.x) + std::sin(40 * p.y);
  });
  for (int repetition = 0; repetition < 20; ++repetition) {
    TriangleMesh mesh;
    MemoryMeshSink sink(mesh);
    DiagnosticSink diagnostics;
    EXPECT_THROW((void)contour(source, sink, {}, {.jobs = 2}, diagnostics), std::bad_alloc);
  }
}

}  // namespace
}  // namespace meso::implicit
