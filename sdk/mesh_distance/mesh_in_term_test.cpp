// SPDX-License-Identifier: Apache-2.0
// A mesh as one field among others: the same mesh of the whole however it is computed, values to the bit those of the
// plain walk, and within the run's limits.
#include <gtest/gtest.h>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

Term mesh_term(const TriangleMesh& mesh, const Affine& map = {}) {
  DiagnosticSink sink;
  return Term::external(MeshField::make(mesh, "mesh", {}, sink), map);
}

/// Without sines, whose last bits depend on who computes them.
Term waves(double period) {
  const auto wave = [&](std::size_t axis) {
    const Term x = Term::coordinate(axis) / Term::constant(period);
    const Term t = x - Term::apply(Op::round, {x});
    return t * (abs(t) - 0.5);
  };
  return (16 * period) * (wave(0) * wave(1) + wave(1) * wave(2) + wave(2) * wave(0));
}

Term gyroid(double period) {
  const auto at = [&](Op op, std::size_t axis) {
    return Term::apply(op, {(2 * 3.14159265358979 / period) * Term::coordinate(axis)});
  };
  Term sum;
  for (std::size_t axis = 0; axis < 3; ++axis) sum = sum + at(Op::cos, axis) * at(Op::sin, (axis + 1) % 3);
  return period * sum;
}

const Grid grid{.box = {{-1.25, -1.25, -1.25}, {1.25, 1.25, 1.5}}, .nodes = {81, 64, 60}};

TriangleMesh contoured(const Term& term, const CompileOptions& options, unsigned jobs, bool polish = false) {
  DiagnosticSink sink;
  const RunOptions run{.jobs = jobs};
  TriangleMesh mesh;
  MemoryMeshSink out(mesh);
  const auto source = compile(term, grid, options, run, sink);
  EXPECT_TRUE(source && contour(*source, out, {.polish = polish}, run, sink));
  return mesh;
}

TEST(MeshInTerm, FilledWithAGyroidItHasTheSameBytesHoweverItIsComputed) {
  const Affine turned{rotation({0.6, 0, 0.8}, 1), {0.1, 0.05, -0.1}};
  const TriangleMesh ball = icosphere(4);
  for (const Term& term : {max(mesh_term(ball), gyroid(0.7)), max(mesh_term(ball, turned), gyroid(0.7)),
                           min(abs(mesh_term(ball) + 0.1) - 0.06, max(mesh_term(ball), gyroid(0.5)))}) {
    const TriangleMesh plain = contoured(term, {.instruction_set = InstructionSet::sse2, .pruning = Pruning::off}, 1);
    EXPECT_GT(plain.triangles.size(), 10'000u);
    const auto expect_same = [&](const CompileOptions& options, unsigned jobs) {
      const TriangleMesh other = contoured(term, options, jobs);
      EXPECT_TRUE(other.points == plain.points && other.triangles == plain.triangles);
    };
    for (const unsigned jobs : {2u, 7u}) expect_same({}, jobs);
    expect_same({.pruning = Pruning::on}, 1);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512})
      if (is_supported(set)) expect_same({.instruction_set = set}, 2);
  }
}

TEST(MeshInTerm, ValuesAtCrossedEdgesAreThoseOfThePlainWalk) {
  const Term ball = mesh_term(icosphere(3)), spikes = mesh_term(spiky_saddle(7), Affine::from_translation({0.2, 0, 0}));
  const Term turned = mesh_term(icosphere(2), {rotation({0, 0.6, 0.8}, 2), {0.3, 0.1, 0}});
  std::size_t asked = 0;
  for (const Term& term :
       {max(ball, waves(0.6)), max(ball - 0.1, waves(0.4)), abs(ball + 0.2) - 0.15, min(spikes, max(ball, -waves(0.7))),
        max(ball, -(spikes - 0.05)), 3 * max(turned, waves(0.5)) - 0.02, abs(max(ball, waves(0.6))) - 0.05,
        max(ball, spikes + 0.1 * waves(0.5))}) {
    const FlatTerm truth(term);
    const auto source = compile(term, grid, {.strict_math = true});
    // Ends of crossed edges along x, by the signs of the rows.
    std::vector<Vec3> ends;
    for (std::int32_t k = 0; k < 60; k += 7)
      for (std::int32_t j = 0; j < 64; j += 5) {
        double before = 0;
        for (std::int32_t i = 0; i < 81; ++i) {
          const double v = truth.value(grid.node(i, j, k));
          if (i > 0 && (v < 0) != (before < 0)) ends.insert(ends.end(), {grid.node(i - 1, j, k), grid.node(i, j, k)});
          before = v;
        }
      }
    std::vector<double> found(ends.size());
    source->sampler()->values_at(ends, found.data());
    for (std::size_t p = 0; p < ends.size(); ++p) ASSERT_EQ(found[p], truth.value(ends[p]));
    asked += ends.size();
  }
  EXPECT_GT(asked, 2000u);
}

TEST(MeshInTerm, PolishedVerticesLieOnTheSurface) {
  const Term term = max(mesh_term(icosphere(3)), gyroid(0.8));
  const TriangleMesh mesh = contoured(term, {}, 2, true);
  const FlatTerm truth(term);
  const Box3& box = grid.box;
  std::size_t inner = 0;
  for (std::size_t n = 0; n < mesh.points.size(); n += 11) {
    const Vec3 p = mesh.points[n];
    if (p.x == box.min.x || p.x == box.max.x) continue;
    ASSERT_NEAR(truth.value(p), 0, 1e-6);
    ++inner;
  }
  EXPECT_GT(inner, 1000u);
}

TEST(MeshInTerm, ObeysTheRunsLimits) {
  const Term term = max(mesh_term(icosphere(5)), waves(0.5));
  const auto told = [&](const RunOptions& run) {
    DiagnosticSink sink;
    EXPECT_EQ(compile(term, grid, {}, run, sink), nullptr);
    return sink.diagnostics().at(0).code;
  };
  EXPECT_EQ(told({.max_memory_bytes = 1'000'000}), Code::limit_grid_memory);
  EXPECT_EQ(told({.cancelled = [] { return true; }}), Code::cancelled);
  EXPECT_EQ(told({.deadline = std::chrono::steady_clock::now()}), Code::limit_time);
  // What is held counts when contouring begins.
  DiagnosticSink sink;
  const auto source = compile(term, grid);
  EXPECT_GT(source->bytes(), 20'480u * 72);
  TriangleMesh mesh;
  MemoryMeshSink out(mesh);
  EXPECT_FALSE(contour(*source, out, {}, {.max_memory_bytes = source->bytes()}, sink));
  EXPECT_EQ(sink.diagnostics().at(0).code, Code::limit_grid_memory);
}

}  // namespace
}  // namespace meso::implicit
