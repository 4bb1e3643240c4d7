// SPDX-License-Identifier: Apache-2.0
// Filling a grid: nanoseconds per sample of every named surface and of other expressions, one thread, rows of 800, and
// muParser's bulk mode on the same text. bench/implicit_table.py prints them side by side.
#include <benchmark/benchmark.h>
#include <muParser.h>

#include <cstdlib>
#include <numbers>
#include <vector>

#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"
#include "meso/implicit/surfaces.hpp"

namespace {

using namespace meso;
using namespace meso::implicit;

constexpr std::int32_t row = 800, planes = 16;

const Grid grid{.box = {{-1, -1, -1}, {1, 1, 2.0 * (planes - 1) / (row - 1) - 1}}, .nodes = {row, row, planes}};

void set_rate(benchmark::State& state, double samples_per_iteration) {
  // benchmark counts per second; inverted it is seconds per sample, times 1e9 what the name says.
  state.counters["ns_per_sample"] = benchmark::Counter(
      samples_per_iteration * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void fill(benchmark::State& state, const Term& term) {
  const auto source = compile(term, grid);
  const auto sampler = source->sampler();
  auto* values = static_cast<float*>(std::aligned_alloc(64, 832 * sizeof(float)));
  auto* inside = static_cast<std::uint64_t*>(std::aligned_alloc(64, 128));
  for (auto _ : state) {
    sampler->begin_slab(0, planes);
    for (std::int32_t k = 0; k < planes; ++k)
      for (std::int32_t j = 0; j < row; ++j) sampler->row(j, k, values, inside);
    benchmark::DoNotOptimize(*values);
    benchmark::DoNotOptimize(*inside);
  }
  set_rate(state, static_cast<double>(grid.node_count()));
  std::free(values);
  std::free(inside);
}

void bulk(benchmark::State& state, const std::string& text) {
  std::vector<double> x(row), y(row), z(row, 0.3), out(row);
  for (int i = 0; i < row; ++i) {
    x[static_cast<std::size_t>(i)] = grid.coordinate(0, i);
    y[static_cast<std::size_t>(i)] = 0.7;
  }
  mu::Parser parser;
  parser.DefineConst("pi", std::numbers::pi);
  parser.DefineVar("x", x.data());
  parser.DefineVar("y", y.data());
  parser.DefineVar("z", z.data());
  parser.SetExpr(text);
  for (auto _ : state) {
    parser.Eval(out.data(), row);
    benchmark::DoNotOptimize(out[0]);
  }
  set_rate(state, row);
}

constexpr std::pair<const char*, const char*> expressions[] = {
    {"ball and box", "max(sqrt(x^2 + y^2 + z^2) - 1, max(abs(x), abs(y)) - 0.8)"},
    {"radial wave", "sin(2*pi*sqrt(x^2 + y^2)) + 0.2*z"},
    {"radial waves of two kinds", "sin(2*pi*sqrt(x^2 + y^2))*cos(2*pi*z) + sin(2*pi*sqrt(x^2 + y^2 + z^2))"},
    {"warped gyroid",
     "cos(2*pi*(x+0.1*sin(3*y*z)))*sin(2*pi*(y+0.1*x*z)) + cos(2*pi*(y+0.1*x*z))*sin(2*pi*z) + "
     "cos(2*pi*z)*sin(2*pi*(x+0.1*sin(3*y*z)))"},
    {"logistic blend",
     "(cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)) / (1 + exp(-4*(x+y))) + "
     "(cos(2*pi*x) + cos(2*pi*y) + cos(2*pi*z)) / (1 + exp(4*(x+y)))"},
    {"powers and arcs", "atan(x*y*z) + (1.5 + x)^2.5 - abs(y - z)^3"},
};

}  // namespace

int main(int argc, char** argv) {
  const auto add = [](const std::string& name, const std::string& text) {
    DiagnosticSink sink;
    const auto field = Field::expression(text, sink);
    benchmark::RegisterBenchmark(("fill/" + name).c_str(),
                                 [term = field->term()](benchmark::State& s) { fill(s, term); });
    benchmark::RegisterBenchmark(("muparser/" + name).c_str(), [text](benchmark::State& s) { bulk(s, text); });
  };
  for (const Surface& surface : surfaces()) add("tpms." + std::string(surface.name), std::string(surface.expression));
  for (const auto& [name, text] : expressions) add(name, text);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
