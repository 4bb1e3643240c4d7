// SPDX-License-Identifier: Apache-2.0
// Reading and writing: documents per second at the size people write, bytes per second at the size programs write.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <string>

#include "meso/xml/read.hpp"
#include "meso/xml/write.hpp"

namespace {

/// A truss cell with `nodes` nodes and as many beams.
std::string document_text(std::int64_t nodes) {
  std::string text =
      "<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"millimeter\">\n  <parameters>\n"
      "    <parameter id=\"pitch\" value=\"5mm\" min=\"1mm\"/>\n  </parameters>\n  <unitCells>\n"
      "    <unitCell id=\"truss\">\n      <beams radius=\"pitch/10\">\n";
  for (std::int64_t i = 0; i < nodes; ++i) {
    const std::string n = std::to_string(i);
    text += "        <node id=\"n" + n + "\" x=\"pitch*" + n + "\" y=\"0\" z=\"pitch/2\"/>\n";
  }
  for (std::int64_t i = 0; i + 1 < nodes; ++i)
    text += "        <beam from=\"n" + std::to_string(i) + "\" to=\"n" + std::to_string(i + 1) + "\"/>\n";
  return text + "      </beams>\n    </unitCell>\n  </unitCells>\n</meso>\n";
}

meso::Document read_or_exit(const std::string& text) {
  meso::DiagnosticSink sink;
  auto result = meso::read_document(text, "bench.meso", sink);
  if (!result) std::abort();
  return std::move(result->document);
}

void read(benchmark::State& state) {
  const std::string text = document_text(state.range(0));
  for (auto _ : state) {
    meso::DiagnosticSink sink;
    benchmark::DoNotOptimize(meso::read_document(text, "bench.meso", sink));
  }
  state.SetItemsProcessed(state.iterations());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(read)->Arg(9)->Arg(1000)->Arg(100'000)->Unit(benchmark::kMicrosecond);

void write_canonical(benchmark::State& state) {
  const std::string text = document_text(state.range(0));
  const meso::Document document = read_or_exit(text);
  for (auto _ : state) benchmark::DoNotOptimize(meso::canonical_document(document));
  state.SetItemsProcessed(state.iterations());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(write_canonical)->Arg(9)->Arg(1000)->Arg(100'000)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
