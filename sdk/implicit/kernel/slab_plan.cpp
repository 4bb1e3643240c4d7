// SPDX-License-Identifier: Apache-2.0
#include "slab_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "meso/implicit/interval_arithmetic.hpp"

namespace meso::implicit {

using expr::Op;
using Id = Graph::Id;

namespace {

// A kept program holds about 30 KiB; with more patterns than this the full program is as good.
constexpr std::size_t max_programs = 256;
// Blocks of one sign between two runs that are computed nevertheless: 32 samples cost less than starting a run.
constexpr std::size_t max_gap = 2 * BlockIntervals::side;

bool is_choice(Op op) { return op == Op::min || op == Op::max || op == Op::select; }

/// Nanoseconds per sample of one step, roughly, with AVX2 (bench/implicit_kernel_bench.cpp).
double cost(const Graph& graph, Id id) {
  if (graph.is_external(id)) return 20;
  if (graph[id].op == sum_of_products) return 0.1 + 0.035 * static_cast<double>(graph.operands(id).size());
  switch (graph[id].op) {
    case Op::sqrt:
    case Op::divide:
      return 0.7;
    case Op::sin:
    case Op::cos:
    case Op::exp:
    case Op::log:
    case Op::hypot:
    case Op::mod:
    case Op::floor:
    case Op::ceil:
    case Op::round:
      return 2;
    case Op::tan:
    case Op::asin:
    case Op::acos:
    case Op::atan:
    case Op::atan2:
      return 4;
    case Op::power:
    case Op::hash:
      return 10;
    default:
      return 0.2;
  }
}

}  // namespace

SlabPlan::SlabPlan(const Plan& plan, MakeProgram make_program)
    : plan_(plan),
      make_program_(std::move(make_program)),
      intervals_(plan),
      steps_(plan.nodes(Plan::Where::step)),
      stands_for_(plan.graph().size()),
      needed_(plan.graph().size()),
      read_(plan.graph().size()),
      full_program_(make_program_(steps_, {})),
      rows_(intervals_.y_blocks()) {
  std::iota(stands_for_.begin(), stands_for_.end(), Id{0});
  for (const Id id : steps_)
    if (is_choice(plan.graph()[id].op)) choosing_.push_back(id);
}

void SlabPlan::enter_slab(std::int32_t first, std::int32_t last) {
  intervals_.enter_slab(first, last);
  for (std::size_t y_block = 0; y_block < rows_.size(); ++y_block) {
    intervals_.enter_blocks_of_row(y_block);
    plan_row(rows_[y_block]);
  }
}

void SlabPlan::plan_row(RowPlan& row) {
  constexpr auto side = static_cast<std::size_t>(BlockIntervals::side);
  row.runs.clear();
  row.inside.assign(padded(intervals_.x_blocks() * side) / row_unit, 0);
  for (std::size_t block = 0; block < intervals_.x_blocks(); ++block) {
    const Interval& values = intervals_.of_block(block);
    if (values.all_inside()) row.inside[block] = 0xffff;
    if (values.all_inside() || values.all_outside()) continue;
    Program* const program = this->program();
    const std::size_t begin = block * side;
    const std::size_t gap = program == full_program_.get() ? max_gap : 0;
    if (!row.runs.empty() && row.runs.back().program == program && row.runs.back().end + gap >= begin)
      row.runs.back().end = begin + side;
    else
      row.runs.push_back({begin, begin + side, program});
  }
}

/// Which node each choice comes to, and which steps are then still needed.
void SlabPlan::find_choices() {
  const Graph& graph = plan_.graph();
  for (const Id id : choosing_) {
    const auto operands = graph.operands(id);
    std::array<Interval, 3> of_operands;
    for (std::size_t k = 0; k < operands.size(); ++k) of_operands[k] = intervals_[operands[k]];
    const Choice choice = choice_of(graph[id].op, {of_operands.data(), operands.size()});
    const std::size_t first = graph[id].op == Op::select ? 1 : 0;
    stands_for_[id] = choice == Choice::none ? id : stands_for_[operands[choice == Choice::first ? first : first + 1]];
  }
  std::fill(needed_.begin(), needed_.end(), false);
  std::fill(read_.begin(), read_.end(), false);
  const auto read = [&](Id id) {
    read_[id] = true;
    needed_[stands_for_[id]] = true;
  };
  read(plan_.root());
  for (auto id = steps_.rbegin(); id != steps_.rend(); ++id)
    if (needed_[*id])
      for (const Id operand : graph.operands(*id)) read(operand);
}

Program* SlabPlan::program() {
  if (choosing_.empty()) return full_program_.get();
  find_choices();
  std::vector<Id> left;
  for (const Id id : steps_)
    if (needed_[id]) left.push_back(id);
  if (left.size() == steps_.size()) return full_program_.get();
  const std::size_t steps = left.size();
  for (const Id id : choosing_) left.push_back(read_[id] ? stands_for_[id] : id);
  const auto found = programs_.find(left);
  if (found != programs_.end()) return found->second.get();
  if (programs_.size() == max_programs) return full_program_.get();
  auto program = make_program_({left.data(), steps}, stands_for_);
  return programs_.emplace(std::move(left), std::move(program)).first->second.get();
}

bool pruning_pays(const Plan& plan, std::int32_t slab) {
  constexpr double interval_operation = 12, start_of_run = 40, blocks_per_run = 3, store = 0.1;  // ns
  const std::vector<Id> steps = plan.nodes(Plan::Where::step);
  double per_sample = store;
  for (const Id id : steps) per_sample += cost(plan.graph(), id);

  BlockIntervals intervals(plan);
  const auto part = [](double n, double t) { return static_cast<std::size_t>(n * (t - std::floor(t))); };
  int asked = 0, active = 0;
  for (int s = 0; s < 6; ++s) {
    const auto first = static_cast<std::int32_t>(part(plan.grid().nodes[2], 0.5 + 0.618034 * s)) / slab * slab;
    intervals.enter_slab(first, std::min(first + slab, plan.grid().nodes[2]));
    for (int r = 0; r < 6; ++r) {
      intervals.enter_blocks_of_row(part(static_cast<double>(intervals.y_blocks()), 0.5 + 0.7548777 * (6 * s + r)));
      for (int b = 0; b < 6; ++b, ++asked) {
        const double t = 0.5 + 0.5698403 * (36 * s + 6 * r + b);
        const Interval& values = intervals.of_block(part(static_cast<double>(intervals.x_blocks()), t));
        active += !values.all_inside() && !values.all_outside();
      }
    }
  }
  const double share = static_cast<double>(active) / asked, rows = BlockIntervals::side * slab;
  const double gain = (1 - share) * rows * BlockIntervals::side * per_sample;
  const double loss =
      interval_operation * static_cast<double>(steps.size()) + share * rows * start_of_run / blocks_per_run;
  return gain > 1.5 * loss;
}

}  // namespace meso::implicit
