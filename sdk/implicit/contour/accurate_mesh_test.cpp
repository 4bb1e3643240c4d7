// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/accurate_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "function_source_for_test.hpp"
#include "meso/base/memory_outlook.hpp"
#include "meso/mesh/audit_mesh.hpp"
#include "meso/mesh/closest_point.hpp"
#include "meso/mesh/self_contact.hpp"

namespace meso::implicit {
namespace {

using Function = FunctionSource::Function;

constexpr double pi = std::numbers::pi;

Box3 cube(double half = 1) { return {{-half, -half, -half}, {half, half, half}}; }

SourceOn on(const Function& f) {
  return [f](const Grid& grid) { return std::make_unique<FunctionSource>(grid, f); };
}

AccurateMesh made(const Function& f, const Grid& grid, const AccurateMeshOptions& options, const RunOptions& run = {}) {
  DiagnosticSink diagnostics;
  const auto result = make_accurate_mesh(on(f), grid, options, run, diagnostics);
  EXPECT_TRUE(result);
  for (const Diagnostic& d : diagnostics.diagnostics()) ADD_FAILURE() << render(d);
  return result.value_or(AccurateMesh{});
}

/// The largest of a function over points spread over all triangles: an independent look at the distance.
template <class Distance>
double farthest(const TriangleMesh& mesh, Distance distance) {
  double worst = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    for (int i = 0; i <= 12; ++i)
      for (int j = 0; i + j <= 12; ++j) worst = std::max(worst, distance((i * a + j * b + (12 - i - j) * c) / 12));
  }
  return worst;
}

double ball(Vec3 p) { return norm(p) - 0.8; }
/// Not a distance: steep here, flat there.
double steep_ball(Vec3 p) { return (dot(p, p) - 0.64) * (2 + p.x) * 7; }
double off_ball(Vec3 p) { return std::fabs(norm(p) - 0.8); }

TEST(AccurateMesh, IsAsCloseToABallAsItIsAsked) {
  std::size_t triangles = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const AccurateMesh result = made(steep_ball, {.box = cube()}, {.tolerance = tolerance});
    EXPECT_TRUE(audit_mesh(result.mesh).watertight());
    const double worst = farthest(result.mesh, off_ball);
    EXPECT_LE(worst, tolerance);
    EXPECT_LE(result.distance, tolerance);
    EXPECT_GE(result.distance, 0.7 * worst);  // not merely said
    EXPECT_GT(result.mesh.triangles.size(), triangles);
    triangles = result.mesh.triangles.size();
  }
  // A sphere takes about 4 pi r^2 / (3 sqrt(3) r tolerance) triangles of the best shape: this is not far from it.
  EXPECT_LT(static_cast<double>(triangles), 12 * 4 * pi * 0.8 / (3 * std::sqrt(3) * 1e-4));
}

double drilled(Vec3 p) {
  const Vec3 q = transposed(rotation(Vec3{1, 2, 3} / std::sqrt(14), 0.6)) * p;
  return std::max({std::fabs(q.x) - 0.6, std::fabs(q.y) - 0.5, std::fabs(q.z) - 0.4, 0.25 - std::hypot(q.x, q.y)});
}
const double drilled_volume = 1.2 * 1.0 * 0.8 - 0.8 * pi * 0.25 * 0.25;

TEST(AccurateMesh, KeepsEdgesWhileItRefines) {
  const AccurateMesh result = made(drilled, {.box = cube()}, {.tolerance = 1e-4});
  const MeshAudit audit = audit_mesh(result.mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(result.euler, 0);  // one hole
  EXPECT_NEAR(audit.volume, drilled_volume, 2 * pi * 0.25 * 0.8 * 1e-4 + 1e-5);
  EXPECT_LE(farthest(result.mesh, [](Vec3 p) { return std::fabs(drilled(p)); }), 1e-4);
}

TEST(AccurateMesh, TakesTheGridsWordWhereTwoCellsAreWithinTheTolerance) {
  const AccurateMesh result = made(drilled, {.box = cube()}, {.tolerance = 0.5});
  EXPECT_TRUE(audit_mesh(result.mesh).watertight());
  EXPECT_DOUBLE_EQ(result.distance, 2 * std::sqrt(3) * result.grid.spacing(0));
  EXPECT_LE(result.distance, 0.5);
  EXPECT_LE(farthest(result.mesh, [](Vec3 p) { return std::fabs(drilled(p)); }), result.distance);
}

/// A lattice's values end at its reach: over a slope of nearly nothing they say that the surface is miles away.
TEST(AccurateMesh, TellsNoDistanceBeyondTheMesh) {
  const auto flat = [](Vec3 p) { return std::max(drilled(p), -0.02 + 1e-6 * p.x); };
  DiagnosticSink diagnostics;
  const auto result = make_accurate_mesh(on(flat), {.box = cube()}, {.tolerance = 5e-3}, {}, diagnostics);
  ASSERT_TRUE(result);
  EXPECT_TRUE(audit_mesh(result->mesh).watertight());
  EXPECT_LE(result->distance, 0.25);
}

double gyroid(Vec3 p, double cell) {
  const double t = 2 * pi / cell;
  return std::cos(t * p.x) * std::sin(t * p.y) + std::cos(t * p.y) * std::sin(t * p.z) +
         std::cos(t * p.z) * std::sin(t * p.x);
}

TEST(AccurateMesh, StaysInTheBoxsPlanes) {
  const AccurateMesh result = made([](Vec3 p) { return gyroid(p, 1); }, {.box = cube()}, {.tolerance = 1e-3});
  const MeshAudit audit = audit_mesh(result.mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.box, cube());
  EXPECT_NEAR(audit.volume, 4.0, 1e-4);  // odd under inversion: half of the box
  EXPECT_EQ(audit.degenerate, 0u);
}

/// Not by the field: from sample points of the mesh to the surface itself, of which the nearest point is known.
struct Shape {
  const char* name;
  Function field;
  double (*distance)(Vec3);
};

double from_segment(Vec3 p, Vec3 a, Vec3 b) {
  return norm(p - a - std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0) * (b - a));
}

// A wedge of 20 degrees, its edge along z.
constexpr double wedge_slope = 0.36397;  // tan 20 deg
double wedge(Vec3 p) {
  return std::max(
      {-p.y, (p.y - wedge_slope * (p.x + 0.77)) / std::hypot(1, wedge_slope), p.x - 0.71, std::fabs(p.z) - 0.53});
}
double off_wedge(Vec3 p) {
  const auto profile = [](double x, double y) {
    const Vec3 q{x, y, 0}, tip{-0.77, 0, 0}, low{0.71, 0, 0}, high{0.71, wedge_slope * 1.48, 0};
    return std::min({from_segment(q, tip, low), from_segment(q, low, high), from_segment(q, high, tip)});
  };
  const bool in_profile = p.y > 0 && p.x < 0.71 && p.y < wedge_slope * (p.x + 0.77);
  const double side = std::fabs(p.z) - 0.53, around = profile(p.x, p.y);
  if (in_profile) return side > 0 ? side : std::min(around, -side);
  return side > 0 ? std::hypot(side, around) : around;
}

// Two spheres that meet in a ring at 50 degrees.
constexpr double lens_radius = 1.4, lens_offset = 1.269;
double lens(Vec3 p) {
  return std::max(norm(p + Vec3{0, 0, lens_offset}) - lens_radius, norm(p - Vec3{0, 0, lens_offset}) - lens_radius);
}
double off_lens(Vec3 p) {
  const double r = std::hypot(p.x, p.y);
  const double ring = std::sqrt(lens_radius * lens_radius - lens_offset * lens_offset);
  double nearest = std::hypot(r - ring, p.z);
  for (const double side : {-1.0, 1.0}) {  // the nearest point of a sphere counts if it is of the lens
    const double z = p.z + side * lens_offset, length = std::hypot(r, z);
    if (side * (z / length * lens_radius - side * lens_offset) >= 0)
      nearest = std::min(nearest, std::fabs(length - lens_radius));
  }
  return nearest;
}

// A cone of 30 degrees to both sides of its axis, cut off below.
double cone(Vec3 p) {
  return std::max((std::hypot(p.x, p.y) - (0.83 - p.z) / std::sqrt(3)) * std::sqrt(3) / 2, -0.41 - p.z);
}
double off_cone(Vec3 p) {
  const Vec3 q{std::hypot(p.x, p.y), p.z, 0}, rim{1.24 / std::sqrt(3), -0.41, 0};
  return std::min(from_segment(q, {0, 0.83, 0}, rim), from_segment(q, {0, -0.41, 0}, rim));
}

TEST(AccurateMesh, ComesAsCloseToWedgesAndTips) {
  const auto expect_close = [](const Shape& shape, double tolerance) {
    const AccurateMesh result = made(shape.field, {.box = cube()}, {.tolerance = tolerance});
    EXPECT_TRUE(audit_mesh(result.mesh).watertight()) << shape.name;
    EXPECT_LE(result.distance, tolerance) << shape.name;
    EXPECT_LE(farthest(result.mesh, shape.distance), tolerance) << shape.name << ' ' << tolerance;
  };
  expect_close({"wedge", wedge, off_wedge}, 5e-2);
  expect_close({"lens", lens, off_lens}, 2e-3);
  expect_close({"cone", cone, off_cone}, 5e-3);
}

/// The other way: from points of the surface to the nearest triangle.
double farthest_of(const std::vector<Vec3>& points, const TriangleMesh& mesh) {
  double worst = 0;
  for (const Vec3& p : points) {
    double nearest = HUGE_VAL;
    for (const auto& t : mesh.triangles)
      nearest = std::min(nearest, norm(to_closest_point({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, p)));
    worst = std::max(worst, nearest);
  }
  return worst;
}

// A box turned against the hole through it: rims in oblique planes, of which chords are nearer to the sheets than to
// the rim.
const Mat3 tilt = rotation(Vec3{1, 2, 0.5} / std::sqrt(5.25), 0.45);
constexpr double tilted_hole = 0.32;
double tilted(Vec3 p) {
  const Vec3 q = transposed(tilt) * p;
  return std::max(
      {std::fabs(q.x) - 0.8, std::fabs(q.y) - 0.64, std::fabs(q.z) - 0.4, tilted_hole - std::hypot(p.x, p.y)});
}
std::vector<Vec3> tilted_rims() {
  std::vector<Vec3> points;
  for (int step = 0; step < 600; ++step)
    for (const double side : {-0.4, 0.4}) {
      const double angle = 2 * pi * step / 600, x = tilted_hole * std::cos(angle), y = tilted_hole * std::sin(angle);
      const Vec3 up = tilt.column(2);  // the two large sides are all that the hole goes through
      points.push_back({x, y, (side - x * up.x - y * up.y) / up.z});
    }
  return points;
}

TEST(AccurateMesh, IsAsCloseToObliqueRims) {
  for (const Vec3& p : tilted_rims()) ASSERT_NEAR(tilted(p), 0, 1e-12);
  for (const double tolerance : {4e-3, 8e-4}) {
    const AccurateMesh result = made(tilted, {.box = cube()}, {.tolerance = tolerance});
    EXPECT_TRUE(audit_mesh(result.mesh).watertight());
    EXPECT_LE(farthest(result.mesh, [](Vec3 p) { return std::fabs(tilted(p)); }), tolerance);
    EXPECT_LE(farthest_of(tilted_rims(), result.mesh), tolerance);
  }
}

TEST(AccurateMesh, IsAsCloseToTheEdgesOfWedges) {
  std::vector<Vec3> tip, ring;
  const double radius = std::sqrt(lens_radius * lens_radius - lens_offset * lens_offset);
  for (int i = 0; i < 97; ++i) {
    tip.push_back({-0.77, 0, 1.06 * i / 96 - 0.53});
    ring.push_back({radius * std::cos(2 * pi * i / 97), radius * std::sin(2 * pi * i / 97), 0});
  }
  const AccurateMesh of_wedge = made(wedge, {.box = cube()}, {.tolerance = 5e-2});
  EXPECT_LE(farthest_of(tip, of_wedge.mesh), 5e-2);
  const AccurateMesh of_lens = made(lens, {.box = cube()}, {.tolerance = 2e-3});
  EXPECT_LE(farthest_of(ring, of_lens.mesh), 2e-3);
}

// A wall that is thinner than a cell is a wall with holes. What is said is no less than what is so.
TEST(AccurateMesh, SaysNoLessThanItIs) {
  const auto off_wall = [](Vec3 p) { return std::fabs(std::fabs(norm(p) - 0.75) - 0.03); };
  const auto wall = [](Vec3 p) { return std::fabs(norm(p) - 0.75) - 0.03; };
  for (const double tolerance : {2e-2, 5e-3}) {
    DiagnosticSink diagnostics;
    const auto result = make_accurate_mesh(on(wall), {.box = cube()}, {.tolerance = tolerance}, {}, diagnostics);
    ASSERT_TRUE(result);
    EXPECT_TRUE(audit_mesh(result->mesh).watertight());
    EXPECT_LE(farthest(result->mesh, off_wall), result->distance);
  }
}

// Of two spheres that nearly touch, a coarse grid makes one body: a finer one is taken.
TEST(AccurateMesh, TakesAFinerGridWhereBridgesAreLeft) {
  const auto two = [](Vec3 p) { return std::min(norm(p - Vec3{0.43, 0, 0}), norm(p + Vec3{0.43, 0, 0})) - 0.4; };
  const AccurateMesh result = made(two, {.box = cube()}, {.tolerance = 1e-2, .smallest_feature = 0.125});
  EXPECT_TRUE(audit_mesh(result.mesh).watertight());
  EXPECT_EQ(result.euler, 4);
  EXPECT_LE(farthest(result.mesh, [&](Vec3 p) { return std::fabs(two(p)); }), 1e-2);
}

// A sheet that the planes of a box and a cylinder cut, here and there at a grazing angle; its walls are thinner than
// its curves are wide.
double cut_sheet(Vec3 p) {
  const double steep = 2 * pi / 0.9 * 1.5;
  const double sheet = (std::fabs(gyroid(p, 0.9)) - 0.15) / steep;
  return std::max({sheet, std::fabs(p.z) - 0.61, std::hypot(p.x, p.y) - 0.83});
}

/// How far p is from where the field changes its sign, along its slope, axes and diagonals; no less than the distance.
double off_field(const Function& f, Vec3 p, double most) {
  const bool inside = f(p) < 0;
  for (int step = 1; step <= 16; ++step)
    for (int n = 0; n < 27; ++n) {
      const Vec3 way{n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0};
      if (n != 13 && (f(p + most * step / 16 / norm(way) * way) < 0) != inside) return most * step / 16;
    }
  return HUGE_VAL;
}

TEST(AccurateMesh, ComesAsCloseToSheetsThatAreCut) {
  constexpr double tolerance = 1.2e-2;
  const AccurateMesh result = made(cut_sheet, {.box = cube()}, {.tolerance = tolerance, .smallest_feature = 0.225});
  const MeshAudit audit = audit_mesh(result.mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.degenerate, 0u);
  const std::vector<double> heights(result.mesh.triangles.size(), tolerance / 2);
  EXPECT_EQ(count_self_contacts(result.mesh, heights).deep, 0u);
  for (std::size_t t = 0; t < result.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = result.mesh.triangles[t];
    const Vec3 middle = (result.mesh.points[a] + result.mesh.points[b] + result.mesh.points[c]) / 3;
    ASSERT_LE(off_field(cut_sheet, middle, 1.1 * tolerance), 1.1 * tolerance);
  }
  // The grid that its walls ask for takes 250,000 triangles, its curves some 15,000.
  EXPECT_LT(audit.triangles, 30'000u);
}

// A network that a ball cuts at all angles: tips of several sheets stand within the tolerance, and the grid has points
// on the ball.
double cut_network(Vec3 p) { return std::max((gyroid(p, 1.0 / 3) - p.z) / (2 * pi * 3 * 1.5), norm(p) - 1); }

TEST(AccurateMesh, HasFewSheetsThroughEachOther) {
  constexpr double tolerance = 1e-2;
  for (const double simplify : {0.0, tolerance}) {
    DiagnosticSink told;
    auto result =
        make_accurate_mesh(on(cut_network), {.box = cube()},
                           {.tolerance = tolerance, .simplify = simplify, .smallest_feature = 1.0 / 12}, {}, told);
    ASSERT_TRUE(result);
    EXPECT_FALSE(told.has_errors());
    for (Vec3& p : result->mesh.points)  // as files have them
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(static_cast<float>(p[axis]));
    const MeshAudit audit = audit_mesh(result->mesh);
    EXPECT_TRUE(audit.watertight());
    EXPECT_EQ(audit.degenerate, 0u);
    EXPECT_LE(result->distance, tolerance);
    // 104 and 73 where nothing is taken apart.
    EXPECT_LT(count_self_contacts(result->mesh, chord_heights(result->mesh)).deep, 20u);
  }
}

TEST(AccurateMesh, SimplifiesABoxToItsCorners) {
  const auto box = [](Vec3 p) {
    return std::max({std::fabs(p.x) - 0.61, std::fabs(p.y) - 0.52, std::fabs(p.z) - 0.43});
  };
  const AccurateMesh result = made(box, {.box = cube(), .nodes = {40, 40, 40}}, {.simplify = 1e-4});
  const MeshAudit audit = audit_mesh(result.mesh);
  EXPECT_TRUE(audit.watertight());
  EXPECT_NEAR(audit.volume, 8 * 0.61 * 0.52 * 0.43, 1e-3);
  EXPECT_LT(audit.triangles, 200u);
  EXPECT_LE(result.distance, 1e-4);
}

TEST(AccurateMesh, SimplifiesAsFarAsTheBoundGoes) {
  const Grid grid{.box = cube(), .nodes = {40, 40, 40}};
  std::size_t triangles = SIZE_MAX;
  for (const double bound : {4e-3, 2e-2}) {
    const AccurateMesh result = made(ball, grid, {.simplify = bound});
    EXPECT_TRUE(audit_mesh(result.mesh).watertight());
    EXPECT_LE(farthest(result.mesh, off_ball), bound);
    EXPECT_LE(result.distance, bound);
    EXPECT_LT(result.mesh.triangles.size(), triangles / 2);
    triangles = result.mesh.triangles.size();
  }
  // Caps of the box stay in its planes.
  const AccurateMesh clipped = made([](Vec3 p) { return gyroid(p, 1); }, grid, {.simplify = 1e-2});
  EXPECT_TRUE(audit_mesh(clipped.mesh).watertight());
  EXPECT_EQ(audit_mesh(clipped.mesh).box, cube());
  EXPECT_NEAR(audit_mesh(clipped.mesh).volume, 4.0, 0.04);
}

TEST(AccurateMesh, SaysThatAGridIsTooCoarseToBeSimplified) {
  DiagnosticSink diagnostics;
  const Grid coarse{.box = cube(), .nodes = {12, 12, 12}};
  const auto result = make_accurate_mesh(on(ball), coarse, {.simplify = 1e-3}, {}, diagnostics);
  ASSERT_TRUE(result);
  ASSERT_EQ(diagnostics.diagnostics().size(), 1u);
  const Diagnostic& told = diagnostics.diagnostics()[0];
  EXPECT_EQ(told.code, Code::simplify_from_coarse) << render(told);
  // Half a cell's chord over a ball: h^2 / 8 r for edges, more over triangles.
  const double h = 2.0 / 11;
  EXPECT_GT(std::stod(told.args[0]), h * h / 8 / 0.8);
  EXPECT_LT(std::stod(told.args[0]), 4 * h * h / 8 / 0.8);
}

TEST(AccurateMesh, IsTheSameForAnyNumberOfThreads) {
  const AccurateMeshOptions options{.tolerance = 1e-3, .simplify = 2e-3};
  const AccurateMesh one = made(drilled, {.box = cube()}, options, {.jobs = 1});
  const AccurateMesh four = made(drilled, {.box = cube()}, options, {.jobs = 4});
  EXPECT_EQ(one.mesh.points, four.mesh.points);
  EXPECT_EQ(one.mesh.triangles, four.mesh.triangles);
}

TEST(AccurateMesh, SaysWhatATinyToleranceWouldTake) {
  DiagnosticSink diagnostics;
  EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, {.tolerance = 1e-9}, {}, diagnostics));
  ASSERT_EQ(diagnostics.error_count(), 1u);
  EXPECT_EQ(diagnostics.diagnostics()[0].code, Code::limit_tolerance);
}

TEST(AccurateMesh, SaysBeforeTheWorkWhatItTakes) {
  const AccurateMeshOptions options{.tolerance = 1e-4};
  const double triangles = static_cast<double>(made(ball, {.box = cube()}, options).mesh.triangles.size());
  bool has_begun = false;
  const RunOptions run{.max_memory_bytes = 24 << 20,
                       .progress = [&](std::string_view stage, double) { has_begun |= stage == "refining"; }};
  DiagnosticSink diagnostics;
  EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, options, run, diagnostics));
  ASSERT_EQ(diagnostics.diagnostics().size(), 1u);
  const Diagnostic& told = diagnostics.diagnostics()[0];
  ASSERT_EQ(told.code, Code::limit_tolerance) << render(told);
  EXPECT_GT(std::stod(told.args[1]), triangles / 1.5);
  EXPECT_LT(std::stod(told.args[1]), triangles * 1.5);
  EXPECT_FALSE(has_begun);
}

TEST(AccurateMesh, SaysWhatItTakesWhateverTheBudget) {
  const AccurateMeshOptions options{.tolerance = 2e-5, .sharp = false};
  const double triangles = static_cast<double>(made(ball, {.box = cube()}, options).mesh.triangles.size());
  for (const std::uint64_t mebibytes : {1, 42, 60, 75}) {
    DiagnosticSink diagnostics;
    const RunOptions run{.max_memory_bytes = mebibytes << 20};
    EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, options, run, diagnostics)) << mebibytes;
    ASSERT_EQ(diagnostics.diagnostics().size(), 1u);
    const Diagnostic& told = diagnostics.diagnostics()[0];
    ASSERT_EQ(told.code, Code::limit_tolerance) << render(told);
    EXPECT_GT(std::stod(told.args[1]), triangles / 3) << mebibytes;
    EXPECT_LT(std::stod(told.args[1]), triangles * 3) << mebibytes;
    EXPECT_NEAR(std::stod(told.args[2]), 40 + std::stod(told.args[1]) * 160 / (1 << 20), 1) << mebibytes;
  }
}

TEST(AccurateMesh, SaysWhatItTakesToWhoeverEndsIt) {
  bool is_refined = false;
  const RunOptions run{.max_memory_bytes = 64 << 20,
                       .progress = [&](std::string_view stage, double) { is_refined |= stage == "refining"; },
                       .cancelled = [&] { return is_refined; }};
  DiagnosticSink diagnostics;
  EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, {.tolerance = 1e-4}, run, diagnostics));
  const auto takes = foreseen_memory();
  ASSERT_TRUE(takes);
  EXPECT_EQ(takes->code, Code::limit_tolerance);
  EXPECT_GT(std::stod(takes->args[2]), 64) << "more than the budget, or it would not have been ended for that";
  made(ball, {.box = cube()}, {.tolerance = 1e-3});
  EXPECT_FALSE(foreseen_memory());
}

TEST(AccurateMesh, SaysWhereItCannotBeReached) {
  // Jumps: there is no surface between the values.
  const auto jump = [](Vec3 p) { return p.x + 0.3 * p.y < 0.1 ? -1.0 : 1.0; };
  DiagnosticSink diagnostics;
  const auto result = make_accurate_mesh(on(jump), {.box = cube()}, {.tolerance = 1e-3}, {}, diagnostics);
  ASSERT_TRUE(result);
  EXPECT_TRUE(audit_mesh(result->mesh).watertight());
}

// The tolerance is reached; what --simplify asks for beyond it is not.
TEST(AccurateMesh, SimplifiedToLessThanTheToleranceTellsWhatItIs) {
  DiagnosticSink diagnostics;
  const auto result =
      make_accurate_mesh(on(ball), {.box = cube()}, {.tolerance = 1e-2, .simplify = 1e-4}, {}, diagnostics);
  ASSERT_TRUE(result);
  EXPECT_TRUE(audit_mesh(result->mesh).watertight());
  EXPECT_GT(result->distance, 1e-4);
  EXPECT_LE(farthest(result->mesh, off_ball), result->distance);
  EXPECT_LE(result->distance, 1e-2);
  ASSERT_EQ(diagnostics.diagnostics().size(), 1u) << "one warning a mesh";
  const Diagnostic& told = diagnostics.diagnostics()[0];
  EXPECT_EQ(told.code, Code::tolerance_not_reached) << render(told);
  EXPECT_EQ(told.args[1], "1e-04");
}

TEST(AccurateMesh, WhatIsTooLargeIsToldWhileItGrows) {
  int rounds = 0;
  const RunOptions run{.max_memory_bytes = 60 << 20,
                       .progress = [&](std::string_view stage, double) { rounds += stage == "refining" ? 1 : 0; }};
  DiagnosticSink diagnostics;
  EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, {.tolerance = 4e-5, .sharp = false}, run, diagnostics));
  EXPECT_EQ(rounds, 1) << "neither before the work nor after more of it";
  ASSERT_EQ(diagnostics.error_count(), 1u);
  EXPECT_EQ(diagnostics.diagnostics().back().code, Code::limit_tolerance);
}

TEST(AccurateMesh, SaysHowManyTrianglesBeforeItRefinesThem) {
  bool has_begun = false;
  const RunOptions run{.progress = [&](std::string_view stage, double) { has_begun |= stage == "refining"; },
                       .cancelled = [&] { return has_begun; }};
  DiagnosticSink diagnostics;
  EXPECT_FALSE(make_accurate_mesh(on(ball), {.box = cube()}, {.tolerance = 1e-5}, run, diagnostics));
  ASSERT_FALSE(diagnostics.diagnostics().empty());
  const Diagnostic& told = diagnostics.diagnostics()[0];
  ASSERT_EQ(told.code, Code::tolerance_takes) << render(told);
  // A sphere takes no less than 4 pi r^2 / (3 sqrt(3) r tolerance) triangles.
  EXPECT_GT(std::stod(told.args[1]), 4 * pi * 0.8 / (3 * std::sqrt(3) * 1e-5));
  EXPECT_LT(std::stod(told.args[1]), 12 * 4 * pi * 0.8 / (3 * std::sqrt(3) * 1e-5));
}

// Of a distance that is hardly more than the bound, as many digits are told as tell the two apart.
TEST(AccurateMesh, TellsDistancesBeyondTheBoundAsSuch) {
  const Grid coarse{.box = cube(), .nodes = {12, 12, 12}};
  std::size_t digits = 0;
  double low = 1e-3, high = 0.1;
  for (int step = 0; step < 30; ++step) {
    const double bound = (low + high) / 2;
    DiagnosticSink diagnostics;
    ASSERT_TRUE(make_accurate_mesh(on(ball), coarse, {.simplify = bound}, {}, diagnostics));
    if (diagnostics.diagnostics().empty()) {
      high = bound;
      continue;
    }
    low = bound;
    const Diagnostic& told = diagnostics.diagnostics()[0];
    EXPECT_GT(std::stod(told.args[0]), bound) << render(told);
    digits = std::max(digits, told.args[0].size());
  }
  EXPECT_GT(digits, std::string("0.01234").size()) << "or no bound was near";
}

TEST(AccurateMesh, IsEmptyOutside) {
  const AccurateMesh result = made([](Vec3) { return 1.0; }, {.box = cube()}, {.tolerance = 1e-2, .simplify = 1e-2});
  EXPECT_TRUE(result.mesh.triangles.empty());
}

}  // namespace
}  // namespace meso::implicit
