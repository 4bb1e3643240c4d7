// SPDX-License-Identifier: Apache-2.0
// Evaluations per second of one thread, the plain walk beside the compiled program, and texts parsed per second.
#include <benchmark/benchmark.h>

#include <array>
#include <string>

#include "expression_program.hpp"
#include "meso/expr/expression.hpp"

namespace meso {
namespace {

constexpr std::array<const char*, 4> texts = {
    "0.5*t",
    "t*(1 + 0.2*i)",
    "clamp(0.4 + 0.01*hypot(x, y), 0.4, 1.2)",
    "mod(i + j, 2) == 0 and x > 0 ? 0.5 + 0.1*sin(2*pi*x/10) : 0.3",
};

expr::Expression parsed(const benchmark::State& state) {
  return *expr::parse_expression(texts[static_cast<std::size_t>(state.range(0))], LengthUnit::millimeter).expression;
}

void parse(benchmark::State& state) {
  const std::string text = texts[static_cast<std::size_t>(state.range(0))];
  for (auto _ : state) benchmark::DoNotOptimize(expr::parse_expression(text, LengthUnit::millimeter));
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(text);
}

template <class Evaluate>
void run(benchmark::State& state, Evaluate evaluate) {
  std::array<double, 4> slots = {1, 2, 3, 4};
  for (auto _ : state) {
    slots[0] += 1;
    benchmark::DoNotOptimize(evaluate(slots));
  }
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(texts[static_cast<std::size_t>(state.range(0))]);
}

void walk(benchmark::State& state) {
  const expr::Expression expression = parsed(state);
  run(state, [&](const auto& slots) { return expr::evaluate(expression, slots); });
}

void program(benchmark::State& state) {
  eval::ExpressionProgram compiled(parsed(state));
  run(state, [&](const auto& slots) { return compiled.evaluate(slots); });
}

BENCHMARK(parse)->DenseRange(0, texts.size() - 1);
BENCHMARK(walk)->DenseRange(0, texts.size() - 1);
BENCHMARK(program)->DenseRange(0, texts.size() - 1);

}  // namespace
}  // namespace meso

BENCHMARK_MAIN();
