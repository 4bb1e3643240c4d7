// SPDX-License-Identifier: Apache-2.0
// Contouring alone: the gyroid on [-1,1]^3, closed at the box, from tables of sines and into a sink, by size of the
// grid and number of threads. CPU is that of the process; `fill` samples without contouring, to be subtracted.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/implicit/contour.hpp"

namespace {

using namespace meso;
using namespace meso::implicit;

class Gyroid final : public GridSource {
 public:
  explicit Gyroid(std::int32_t n) : grid_{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {n, n, n}} {
    for (std::int32_t i = 0; i < n; ++i) {
      cos_.push_back(std::cos(2 * std::numbers::pi * grid_.coordinate(0, i)));
      sin_.push_back(std::sin(2 * std::numbers::pi * grid_.coordinate(0, i)));
    }
  }
  [[nodiscard]] const Grid& grid() const override { return grid_; }
  [[nodiscard]] std::unique_ptr<GridSampler> sampler() const override { return std::make_unique<Sampler>(*this); }

 private:
  class Sampler final : public GridSampler {
   public:
    explicit Sampler(const Gyroid& g) : g_(g) {}
    void begin_slab(std::int32_t, std::int32_t) override {}
    void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override {
      const double *const c = g_.cos_.data(), *const s = g_.sin_.data(), sy = s[j], cz = c[k], yz = c[j] * s[k];
      const std::int32_t n = g_.grid_.nodes[0];
      for (std::int32_t begin = 0; begin < n; begin += 64) {
        std::uint64_t bits = 0;
        for (std::int32_t i = begin; i < std::min(n, begin + 64); ++i) {
          const double v = c[i] * sy + s[i] * cz + yz;
          values[i] = static_cast<float>(v);
          bits |= std::uint64_t{v < 0} << i % 64;
        }
        inside[begin / 64] = bits;
      }
    }
    void values_at(std::span<const Vec3> points, double* out) override {
      const double t = 2 * std::numbers::pi;
      for (const Vec3& p : points)
        *out++ = std::cos(t * p.x) * std::sin(t * p.y) + std::cos(t * p.y) * std::sin(t * p.z) +
                 std::cos(t * p.z) * std::sin(t * p.x);
    }

   private:
    const Gyroid& g_;
  };

  Grid grid_;
  std::vector<double> cos_, sin_;
};

void fill(benchmark::State& state) {
  const auto n = static_cast<std::int32_t>(state.range(0));
  const Gyroid gyroid(n);
  const auto sampler = gyroid.sampler();
  std::vector<float> values(static_cast<std::size_t>(n));
  std::vector<std::uint64_t> inside(static_cast<std::size_t>(n) / 64 + 1);
  for (auto _ : state)
    for (std::int32_t k = 0; k < n; ++k)
      for (std::int32_t j = 0; j < n; ++j) {
        sampler->row(j, k, values.data(), inside.data());
        benchmark::DoNotOptimize(values.data());
      }
}

void contour_to(benchmark::State& state, MeshFormat format, const ContourOptions& options) {
  const Gyroid gyroid(static_cast<std::int32_t>(state.range(0)));
  RunOptions run;
  run.jobs = static_cast<unsigned>(state.range(1));
  const std::string path = (std::filesystem::temp_directory_path() / "meso_contour_bench").string();
  for (auto _ : state) {
    DiagnosticSink diagnostics;
    auto file = OutputFile::create(path, ExistingFile::replace, diagnostics);
    if (!file) return state.SkipWithError("cannot write");
    const auto report = contour(gyroid, *make_mesh_writer(format, *file), options, run, diagnostics);
    if (!report || !file->commit(diagnostics)) return state.SkipWithError("no mesh");
    state.counters["triangles"] = static_cast<double>(report->triangles);
    state.PauseTiming();
    std::filesystem::remove(path);
    state.ResumeTiming();
  }
}

void grids(benchmark::internal::Benchmark* bench) {
  for (const int jobs : {1, 2})
    for (const int n : {200, 400, 800}) bench->Args({n, jobs});
  bench->ArgNames({"nodes", "jobs"})->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}

}  // namespace

BENCHMARK(fill)->Arg(200)->Arg(400)->Arg(800)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contour_to, ply, MeshFormat::ply, {})->Apply(grids);
BENCHMARK_CAPTURE(contour_to, stl, MeshFormat::stl, {})->Args({400, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contour_to, obj, MeshFormat::obj, {})->Args({400, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contour_to, vtk, MeshFormat::vtk, {})->Args({400, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contour_to, ply_polished, MeshFormat::ply, {.polish = true})
    ->Args({400, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contour_to, ply_without_slivers, MeshFormat::ply, {.collapse_slivers = true})
    ->Args({200, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
