// SPDX-License-Identifier: Apache-2.0
// The exact engine's stages by number of cells: body, STEP, STL, measures and audit of body-centred cells in a block.
#include <benchmark/benchmark.h>

#include <stdexcept>

#include "meso/brep/audit.hpp"
#include "meso/brep/lattice_body.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"

namespace {

using namespace meso;

/// Bytes are counted and forgotten: what is measured is the writer, not a disk.
class NullSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view bytes) override {
    size += bytes.size();
    return true;
  }
  std::uint64_t size = 0;
};

brep::LatticeCell body_centred() {
  brep::LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {brep::Ball{{2.5, 2.5, 2.5}, 0.9}}};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at{corner & 1 ? 5.0 : 0, corner & 2 ? 5.0 : 0, corner & 4 ? 5.0 : 0};
    cell.primitives.emplace_back(brep::Ball{at, 0.9});
    cell.primitives.emplace_back(brep::Frustum{at, {2.5, 2.5, 2.5}, 0.5, 0.5});
  }
  return cell;
}

brep::Body block(std::int64_t edge) {
  const auto last = static_cast<std::int32_t>(edge - 1);
  const brep::LatticeSet set{.min = {0, 0, 0}, .max = {last, last, last}, .inside = [](brep::Index3) { return true; }};
  DiagnosticSink sink;
  auto body = brep::lattice_body(body_centred(), set, {.mesh = brep::MeshFineness{0.1, 0.5}}, sink);
  if (!body) throw std::runtime_error("no body");
  return std::move(*body);
}

std::int64_t cells_of(const benchmark::State& state) { return state.range(0) * state.range(0) * state.range(0); }

void BM_LatticeBody(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(block(state.range(0)));
  state.SetItemsProcessed(state.iterations() * cells_of(state));
}
BENCHMARK(BM_LatticeBody)
    ->Arg(1)
    ->Arg(3)
    ->Arg(5)
    ->Arg(10)
    ->Arg(20)
    ->Arg(40)
    ->Unit(benchmark::kMillisecond)
    ->MinTime(0.1);

void BM_WriteStep(benchmark::State& state) {
  const brep::Body body = block(state.range(0));
  NullSink sink;
  for (auto _ : state) benchmark::DoNotOptimize(write_step(body, {}, sink));
  state.SetBytesProcessed(static_cast<std::int64_t>(sink.size));
  state.SetItemsProcessed(state.iterations() * cells_of(state));
}
BENCHMARK(BM_WriteStep)->Arg(5)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond)->MinTime(0.1);

void BM_WriteBinaryStl(benchmark::State& state) {
  const brep::Body body = block(state.range(0));
  NullSink sink;
  std::uint64_t triangles = 0;
  for (auto _ : state) triangles += write_stl(brep::triangles_of(body), StlFormat::binary, sink).triangles;
  state.SetBytesProcessed(static_cast<std::int64_t>(sink.size));
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_WriteBinaryStl)->Arg(5)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond)->MinTime(0.1);

void BM_Measure(benchmark::State& state) {
  const brep::Body body = block(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(brep::measure(body));
  state.SetItemsProcessed(state.iterations() * cells_of(state));
}
BENCHMARK(BM_Measure)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond)->MinTime(0.1);

void BM_Audit(benchmark::State& state) {
  const brep::Body body = block(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(brep::audit(body));
  state.SetItemsProcessed(state.iterations() * cells_of(state));
}
BENCHMARK(BM_Audit)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond)->MinTime(0.1);

}  // namespace

BENCHMARK_MAIN();
