// SPDX-License-Identifier: Apache-2.0
// What each part of the row kernels is worth: instruction sets, regrouping, pruning. Nanoseconds per sample of the
// grid, one thread; every eighth slab of eight planes.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"

namespace {

using namespace meso;
using namespace meso::implicit;

void fill(benchmark::State& state, const Term& term, std::int32_t n, const CompileOptions& options) {
  const auto source = compile(term, Grid{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {n, n, n}}, options);
  const auto sampler = source->sampler();
  const auto padded = static_cast<std::size_t>(n + 63) / 64 * 64;
  auto* values = static_cast<float*>(std::aligned_alloc(64, padded * sizeof(float)));
  auto* inside = static_cast<std::uint64_t*>(std::aligned_alloc(64, padded));
  double planes = 0;
  for (auto _ : state) {
    for (std::int32_t first = 0; first < n; first += 64) {
      const std::int32_t last = std::min(first + 8, n);
      planes += last - first;
      sampler->begin_slab(first, last);
      for (std::int32_t k = first; k < last; ++k)
        for (std::int32_t j = 0; j < n; ++j) sampler->row(j, k, values, inside);
    }
    benchmark::DoNotOptimize(*inside);
  }
  // benchmark counts per second; inverted it is seconds per sample, times 1e9 what the name says.
  state.counters["ns_per_sample"] =
      benchmark::Counter(planes * n * n * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  std::free(values);
  std::free(inside);
}

std::string balls() {
  std::string text = "1e9";
  for (int i = 0; i < 60; ++i) {
    const auto at = [i](double step) { return std::to_string(std::fmod(i * step, 1.8) - 0.9); };
    text = "min(" + text + ", sqrt((x - (" + at(0.37) + "))^2 + (y - (" + at(0.53) + "))^2 + (z - (" + at(0.71) +
           "))^2) - 0.12)";
  }
  return text;
}

const std::string gyroid = "(cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x))";
const std::pair<const char*, std::string> fields[] = {
    {"gyroid", gyroid},
    {"warped gyroid",
     "cos(2*pi*(x + 0.1*sin(3*y*z)))*sin(2*pi*(y + 0.1*sin(3*x*z))) + cos(2*pi*(y + 0.1*sin(3*x*z)))*"
     "sin(2*pi*(z + 0.1*sin(3*x*y))) + cos(2*pi*(z + 0.1*sin(3*x*y)))*sin(2*pi*(x + 0.1*sin(3*y*z)))"},
    {"sheets in P in a ball",
     "max(sqrt(x^2 + y^2 + z^2) - 0.9, max(cos(2*pi*x) + cos(2*pi*y) + cos(2*pi*z), abs(" + gyroid + ") - 0.3))"},
    {"60 balls", balls()},
};

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [field_name, text] : fields) {
    DiagnosticSink sink;
    const Term term = Field::expression(text, sink)->term();
    const std::string name = field_name;
    const auto add = [&](const std::string& what, std::int32_t n, const CompileOptions& options) {
      benchmark::RegisterBenchmark((name + "/" + std::to_string(n) + "/" + what).c_str(),
                                   [term, n, options](benchmark::State& s) { fill(s, term, n, options); });
    };
    add("sse2", 400, {.instruction_set = InstructionSet::sse2, .pruning = Pruning::off});
    if (is_supported(InstructionSet::avx2))
      add("avx2", 400, {.instruction_set = InstructionSet::avx2, .pruning = Pruning::off});
    if (is_supported(InstructionSet::avx512))
      add("avx512", 400, {.instruction_set = InstructionSet::avx512, .pruning = Pruning::off});
    add("strict", 400, {.strict_math = true, .pruning = Pruning::off});
    for (const std::int32_t n : {400, 800}) {
      add("unpruned", n, {.pruning = Pruning::off});
      add("pruned", n, {.pruning = Pruning::on});
      add("automatic", n, {});
    }
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
