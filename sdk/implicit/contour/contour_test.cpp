// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/contour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "function_source_for_test.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/mesh/audit_mesh.hpp"

namespace meso::implicit {
namespace {

constexpr double pi = std::numbers::pi;

double gyroid(Vec3 p) {
  const double t = 2 * pi;
  return std::cos(t * p.x) * std::sin(t * p.y) + std::cos(t * p.y) * std::sin(t * p.z) +
         std::cos(t * p.z) * std::sin(t * p.x);
}

Grid cube(std::int32_t n, double half = 1) { return {{{-half, -half, -half}, {half, half, half}}, {n, n, n}}; }

TriangleMesh mesh_of(const Grid& grid, const FunctionSource::Function& f) {
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  DiagnosticSink diagnostics;
  const auto report = contour(FunctionSource(grid, f), sink, {}, {}, diagnostics);
  EXPECT_TRUE(report);
  EXPECT_EQ(report->points, mesh.points.size());
  EXPECT_EQ(report->triangles, mesh.triangles.size());
  return mesh;
}

TEST(Contour, ClosesTheGyroidAtTheBox) {
  const MeshAudit audit = audit_mesh(mesh_of(cube(60), gyroid));
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.degenerate, 0u);
  EXPECT_NEAR(audit.volume, 4.0, 1e-3);
  EXPECT_NEAR(audit.area, 8 * 3.0916 + 12, 0.1);
}

// Signs and sizes without any order, so that thousands of ambiguous faces join.
double noise(Vec3 p) {
  std::uint64_t h = 0;
  for (std::size_t i = 0; i < 3; ++i)
    h = (h ^ static_cast<std::uint64_t>(std::llround(p[i] * 1000) + 100000)) * 0x9e3779b97f4a7c15ULL, h ^= h >> 29;
  return static_cast<double>(h % 2000001) / 1e6 - 1;
}

TEST(Contour, IsAManifoldWhereTheFieldIsNoise) {
  const MeshAudit audit = audit_mesh(mesh_of(cube(60), noise));
  EXPECT_TRUE(audit.watertight());
  EXPECT_EQ(audit.degenerate, 0u);
  EXPECT_GT(audit.triangles, 500000u);
}

}  // namespace
}  // namespace meso::implicit
