// SPDX-License-Identifier: Apache-2.0
// Placed cells per second of one thread: constant patterns, polar ones, three expressions per cell, box queries.
#include <benchmark/benchmark.h>

#include <stdexcept>
#include <string>

#include "meso/eval/evaluation.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace {

using namespace meso;

eval::CellStream stream_of(const std::string& pattern_content, const std::string& attributes = "") {
  const std::string text =
      "<meso xmlns='urn:meso-format:1.0' version='1.0' unit='millimeter'><coordinateSystems>"
      "<coordinateSystem id='polar'><axis name='r' kind='distance' x='1'/><axis name='phi' kind='circular' z='1'/>"
      "<axis name='h' kind='linear' z='1'/></coordinateSystem></coordinateSystems><unitCells><unitCell id='c'>"
      "<parameter id='t' value='1'/><box dx='1' dy='1' dz='1'/><csg><sphere radius='t/2'/></csg></unitCell></unitCells>"
      "<patterns><pattern id='p' unitCell='c' " +
      attributes + ">" + pattern_content + "</pattern></patterns></meso>";
  DiagnosticSink sink;
  auto read = read_document(text, "bench.meso", sink);
  const auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  const auto evaluation = checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
  auto cells = evaluation ? evaluation->cells(*evaluation->find_pattern("p"), sink) : std::nullopt;
  if (!cells) throw std::invalid_argument(sink.diagnostics().empty() ? "no cells" : render(sink.diagnostics()[0]));
  return *cells;
}

void visit_all(benchmark::State& state, const eval::CellStream& cells) {
  DiagnosticSink sink;
  for (auto _ : state) {
    double sum = 0;
    if (!cells.visit(
            0, cells.size(), [&](const eval::PlacedCell& c) { return sum += c.world_from_cell.translation.x, true; },
            sink))
      state.SkipWithError("evaluation failed");
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(cells.size()));
}

const std::string grid =
    "<loop index='i' axis='x' count='100' spacing='1'/><loop index='j' axis='y' count='100' spacing='1'/>"
    "<loop index='k' axis='z' count='100' spacing='1'/>";

void BM_ConstantGrid(benchmark::State& state) { visit_all(state, stream_of(grid)); }
BENCHMARK(BM_ConstantGrid)->Unit(benchmark::kMillisecond);

void BM_ConstantGridTurned(benchmark::State& state) {
  visit_all(state, stream_of(grid + "<rotate x='1' y='0' z='0' angle='30deg'/>"));
}
BENCHMARK(BM_ConstantGridTurned)->Unit(benchmark::kMillisecond);

void BM_PolarRings(benchmark::State& state) {
  visit_all(state, stream_of("<loop index='k' axis='h' count='100' spacing='1'/><loop index='i' axis='r' count='100' "
                             "start='1' spacing='1'/><loop index='j' axis='phi' count='100' spacing='3.6deg'/>",
                             "coordinateSystem='polar'"));
}
BENCHMARK(BM_PolarRings)->Unit(benchmark::kMillisecond);

void BM_ThreeExpressionsPerCell(benchmark::State& state) {
  visit_all(state, stream_of(grid + "<set parameter='t' value='0.5 + 0.01*global.z'/><translate z='0.1*sin(k + i)'/>"
                                    "<rotate x='0' y='0' z='1' angle='0.1*k*j'/>"));
}
BENCHMARK(BM_ThreeExpressionsPerCell)->Unit(benchmark::kMillisecond);

void BM_BoxQueryInAMillionCells(benchmark::State& state) {
  const eval::CellStream cells = stream_of(grid);
  const Box3 region{{40.2, 40.2, 40.2}, {42.2, 42.2, 42.2}};
  DiagnosticSink sink;
  std::int64_t seen = 0;
  for (auto _ : state) {
    if (!cells.visit_touching(
            region, [&](const eval::PlacedCell&) { return ++seen, true; }, sink))
      state.SkipWithError("evaluation failed");
  }
  state.SetItemsProcessed(seen);
}
BENCHMARK(BM_BoxQueryInAMillionCells);

}  // namespace

BENCHMARK_MAIN();
