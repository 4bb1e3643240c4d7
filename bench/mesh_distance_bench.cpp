// SPDX-License-Identifier: Apache-2.0
// Distance to a mesh of a million triangles, a torus in shuffled order: building, signs of 200^3 nodes, and distances
// where the surface passes between nodes. CPU time of all threads.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/mesh_distance/mesh_field.hpp"

namespace {

using meso::Vec3;

meso::TriangleMesh torus(std::uint32_t around, std::uint32_t across) {
  constexpr double large = 0.7, small = 0.25;
  meso::TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = large + small * std::cos(v);
      mesh.points.push_back({r * std::cos(u), r * std::sin(u), small * std::sin(v)});
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return a % around * across + b % across; };
      const std::uint32_t p = at(i, j), q = at(i + 1, j), r1 = at(i + 1, j + 1), s = at(i, j + 1);
      mesh.triangles.push_back({p, q, r1});
      mesh.triangles.push_back({p, r1, s});
    }
  }
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(7));
  return mesh;
}

const meso::TriangleMesh& million() {
  static const meso::TriangleMesh mesh = torus(1000, 500);
  return mesh;
}

std::shared_ptr<const meso::implicit::MeshField> make(unsigned jobs) {
  meso::DiagnosticSink sink;
  auto field = meso::implicit::MeshField::make(million(), "torus", {.jobs = jobs}, sink);
  if (!field || !sink.diagnostics().empty()) std::abort();
  return field;
}

const meso::implicit::Grid& grid() {
  static const meso::implicit::Grid g{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {200, 200, 200}};
  return g;
}

void build(benchmark::State& state) {
  (void)million();
  for (auto _ : state) benchmark::DoNotOptimize(make(static_cast<unsigned>(state.range(0))));
}
BENCHMARK(build)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void signs(benchmark::State& state) {
  const auto field = make(0);
  std::vector<double> row(200);
  std::int64_t inside = 0;
  for (auto _ : state) {
    const auto rows = field->prepare(grid(), {}, 0, {})->make_rows();
    for (std::int32_t k = 0; k < 200; ++k) {
      for (std::int32_t j = 0; j < 200; ++j) {
        rows->row(j, k, 0, 200, row.data());
        inside += std::count_if(row.begin(), row.end(), [](double v) { return v < 0; });
      }
    }
  }
  state.counters["inside"] = static_cast<double>(inside / state.iterations());
}
BENCHMARK(signs)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// Both ends of every edge of the grid whose ends differ in sign.
std::vector<Vec3> crossing_ends(const meso::implicit::MeshField& field) {
  std::vector<char> inside(std::size_t{200} * 200 * 200);
  std::vector<double> row(200);
  const auto rows = field.prepare(grid(), {}, 0, {})->make_rows();
  const auto at = [](std::int32_t i, std::int32_t j, std::int32_t k) {
    return (std::size_t(k) * 200 + std::size_t(j)) * 200 + std::size_t(i);
  };
  for (std::int32_t k = 0; k < 200; ++k) {
    for (std::int32_t j = 0; j < 200; ++j) {
      rows->row(j, k, 0, 200, row.data());
      for (std::int32_t i = 0; i < 200; ++i) inside[at(i, j, k)] = row[std::size_t(i)] < 0;
    }
  }
  std::vector<Vec3> out;
  for (std::int32_t k = 1; k < 199; ++k) {
    for (std::int32_t j = 1; j < 199; ++j) {
      for (std::int32_t i = 1; i < 199; ++i) {
        const char here = inside[at(i, j, k)];
        const bool crossed = inside[at(i - 1, j, k)] != here || inside[at(i + 1, j, k)] != here ||
                             inside[at(i, j - 1, k)] != here || inside[at(i, j + 1, k)] != here ||
                             inside[at(i, j, k - 1)] != here || inside[at(i, j, k + 1)] != here;
        if (crossed) out.push_back(grid().node(i, j, k));
      }
    }
  }
  return out;
}

void values(benchmark::State& state) {
  const auto field = make(0);
  const std::vector<Vec3> points = crossing_ends(*field);
  for (auto _ : state) {
    for (const Vec3& p : points) benchmark::DoNotOptimize(field->value(p));
  }
  double error = 0;
  for (const Vec3& p : points) {
    const double exact = std::hypot(std::hypot(p.x, p.y) - 0.7, p.z) - 0.25;
    error = std::max(error, std::abs(field->value(p) - exact));
  }
  state.counters["points"] = static_cast<double>(points.size());
  state.counters["max_error"] = error;
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(values)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// Rows with exact values in a band of `range` cells.
void band(benchmark::State& state) {
  const auto field = make(0);
  const double width = static_cast<double>(state.range(0)) * grid().spacing(0);
  std::vector<double> row(200);
  for (auto _ : state) {
    const auto rows = field->prepare(grid(), {}, width, {})->make_rows();
    for (std::int32_t k = 0; k < 200; ++k) {
      for (std::int32_t j = 0; j < 200; ++j) rows->row(j, k, 0, 200, row.data());
    }
  }
}
BENCHMARK(band)->Arg(1)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A gyroid within the mesh, 200^3 samples in all: all that follows the reading of the file, on one thread.
void filled_with_gyroid(benchmark::State& state) {
  using namespace meso::implicit;
  (void)million();
  const double per_unit = 2 * std::numbers::pi / 0.35;
  const auto wave = [&](meso::expr::Op op, std::size_t axis) {
    return Term::apply(op, {per_unit * Term::coordinate(axis)});
  };
  Term gyroid;
  for (std::size_t axis = 0; axis < 3; ++axis)
    gyroid = gyroid + wave(meso::expr::Op::cos, axis) * wave(meso::expr::Op::sin, (axis + 1) % 3);
  const meso::RunOptions run{.jobs = 1};
  meso::DiagnosticSink diagnostics;
  std::size_t triangles = 0;
  for (auto _ : state) {
    const auto field = make(1);
    const meso::Box3 box = field->bounds(0);
    const Grid samples{.box = box, .nodes = nodes_for_total(box, 8e6)};
    const auto source = compile(max(Term::external(field), 0.35 * gyroid), samples, {}, run, diagnostics);
    meso::TriangleMesh mesh;
    meso::MemoryMeshSink sink(mesh);
    if (!contour(*source, sink, {}, run, diagnostics)) std::abort();
    triangles = mesh.triangles.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(filled_with_gyroid)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();
