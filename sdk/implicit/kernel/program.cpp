// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <algorithm>
#include <cassert>

namespace meso::implicit {

using expr::Op;

namespace {

// What the intermediate rows may take of a first-level cache of 32 KiB, in doubles.
constexpr std::size_t cached_samples = 3072;
constexpr std::size_t point_rows = 3;

}  // namespace

/// Gives rows to steps: a row is free again after the last step that reads it.
class Program::Assembler {
 public:
  Assembler(Program& program, const Graph& graph, const RowKernels& kernels, const PlaceOf& place_of,
            std::span<const Graph::Id> stands_for)
      : program_(program),
        graph_(graph),
        kernels_(kernels),
        place_of_(place_of),
        stands_for_(stands_for),
        row_of_(graph.size(), none) {}

  void assemble(std::span<const Graph::Id> steps, Graph::Id given_root, const ExternalInputs& externals) {
    const Graph::Id root = read(given_root);
    std::vector<std::size_t> last_use(graph_.size(), 0);
    for (std::size_t s = 0; s < steps.size(); ++s)
      for (const Graph::Id operand : graph_.operands(steps[s])) last_use[read(operand)] = s;
    for (std::size_t s = 0; s < steps.size(); ++s) {
      add_step(steps[s], externals);
      for (const Graph::Id operand : graph_.operands(steps[s]))
        if (last_use[read(operand)] == s) release(read(operand));
      program_.instructions_.back().out = place(steps[s]);
    }
    add_result(steps, root);
    give_memory();
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  [[nodiscard]] Graph::Id read(Graph::Id id) const { return stands_for_.empty() ? id : stands_for_[id]; }

  void add_step(Graph::Id id, const ExternalInputs& externals) {
    Instruction instruction;
    if (graph_.is_external(id)) {
      const std::size_t k = graph_[id].leaf - 3;
      instruction.leaf = &graph_.externals()[k];
      instruction.external = static_cast<std::uint32_t>(k);
      instruction.rows = externals.rows.empty() ? nullptr : externals.rows[k];
    } else {
      instruction.kernel = kernels_.of_op[static_cast<std::size_t>(graph_[id].op)];
      add_operands(instruction, graph_.operands(id));
    }
    program_.instructions_.push_back(instruction);
  }

  void add_operands(Instruction& instruction, std::span<const Graph::Id> ids) {
    instruction.first_operand = static_cast<std::uint32_t>(program_.operands_.size());
    instruction.operands = static_cast<std::uint32_t>(ids.size());
    for (const Graph::Id id : ids) program_.operands_.push_back(place(read(id)));
    program_.inputs_.resize(std::max(program_.inputs_.size(), ids.size()));
  }

  /// A sum of products at the end is stored as it is made.
  void add_result(std::span<const Graph::Id> steps, Graph::Id root) {
    if (!steps.empty() && steps.back() == root && graph_[root].op == sum_of_products) {
      program_.result_ = program_.instructions_.back();
      program_.store_ = kernels_.store_sum_of_products;
    } else {
      add_operands(program_.result_, {&root, 1});
      program_.result_.out = place(root);
      program_.store_ = kernels_.store;
    }
  }

  /// A row of the program's own is an offset until give_memory().
  Operand place(Graph::Id id) {
    if (const auto fixed = place_of_(id)) return *fixed;
    if (graph_[id].op == Op::name && graph_[id].leaf < 3) row_of_[id] = graph_[id].leaf;
    if (row_of_[id] == none) {
      if (free_.empty()) free_.push_back(rows_++);
      row_of_[id] = free_.back();
      free_.pop_back();
    }
    return {.row = static_cast<std::ptrdiff_t>(row_of_[id])};
  }

  void release(Graph::Id id) {
    if (row_of_[id] == none || row_of_[id] < point_rows) return;
    free_.push_back(row_of_[id]);
    row_of_[id] = none;
  }

  void give_memory() {
    program_.chunk_ = std::clamp<std::size_t>(cached_samples / rows_ / 64 * 64, 64, 1024);
    program_.memory_ = AlignedArray(rows_ * program_.chunk_);
    const auto locate = [&](Operand& operand) {
      if (operand.base == nullptr)
        operand = {.base = program_.memory_.data() + static_cast<std::size_t>(operand.row) * program_.chunk_};
    };
    for (Operand& operand : program_.operands_) locate(operand);
    for (Instruction& instruction : program_.instructions_) locate(instruction.out);
    locate(program_.result_.out);
  }

  Program& program_;
  const Graph& graph_;
  const RowKernels& kernels_;
  const PlaceOf& place_of_;
  std::span<const Graph::Id> stands_for_;
  std::vector<std::size_t> row_of_;
  std::vector<std::size_t> free_;
  std::size_t rows_ = point_rows;
};

Program::Program(const Graph& graph, const RowKernels& kernels, std::span<const Graph::Id> steps, Graph::Id root,
                 const PlaceOf& place_of, const ExternalInputs& externals, std::span<const Graph::Id> stands_for)
    : samples_(externals.samples) {
  Assembler(*this, graph, kernels, place_of, stands_for).assemble(steps, root, externals);
}

std::span<const Input> Program::inputs(const Instruction& instruction, std::size_t i, std::size_t j, std::size_t k) {
  const Operand* const operands = operands_.data() + instruction.first_operand;
  for (std::size_t o = 0; o < instruction.operands; ++o) inputs_[o] = {operands[o].at(i, j, k), operands[o].uniform};
  return {inputs_.data(), instruction.operands};
}

void Program::step(const Instruction& instruction, std::size_t i, std::size_t n, std::size_t j, std::size_t k) {
  double* const out = instruction.out.at(i, j, k);
  if (instruction.kernel != nullptr) {
    const auto in = inputs(instruction, i, j, k);
    instruction.kernel(in.data(), in.size(), out, n);
  } else if (instruction.rows != nullptr) {
    const std::size_t end = std::min(i + n, samples_);
    if (i < end)
      instruction.rows->row(static_cast<std::int32_t>(j), static_cast<std::int32_t>(k), static_cast<std::int32_t>(i),
                            static_cast<std::int32_t>(end), out);
  } else {
    external_at_points(instruction, out);
  }
}

void Program::external_at_points(const Instruction& instruction, double* out) const {
  if (!externals_at_points_.empty()) {
    const double* const values = externals_at_points_[instruction.external].data() + first_point_;
    std::copy(values, values + samples_, out);
    return;
  }
  const double* const p = memory_.data();
  for (std::size_t s = 0; s < samples_; ++s)
    out[s] = instruction.leaf->field->value(instruction.leaf->field_from_world *
                                            Vec3{p[s], p[chunk_ + s], p[2 * chunk_ + s]});
}

void Program::run(std::size_t begin, std::size_t end, std::size_t j, std::size_t k) {
  for (std::size_t i = begin; i < end; i += chunk_)
    for (const Instruction& instruction : instructions_) step(instruction, i, std::min(chunk_, end - i), j, k);
}

void Program::sample(std::size_t begin, std::size_t end, std::size_t j, std::size_t k, float* values,
                     std::uint16_t* inside) {
  const std::size_t steps = instructions_.size() - (result_.kernel != nullptr ? 1 : 0);
  for (std::size_t i = begin; i < end; i += chunk_) {
    const std::size_t n = std::min(chunk_, end - i);
    for (std::size_t s = 0; s < steps; ++s) step(instructions_[s], i, n, j, k);
    const auto in = inputs(result_, i, j, k);
    store_(in.data(), in.size(), values + i, inside + i / row_unit, n);
  }
}

void Program::values_at(std::span<const Vec3> points, std::span<const std::vector<double>> externals, double* out) {
  double* const coordinates = memory_.data();
  externals_at_points_ = externals;
  for (std::size_t first = 0; first < points.size(); first += chunk_) {
    first_point_ = first;
    samples_ = std::min(chunk_, points.size() - first);
    const std::size_t n = (samples_ + row_unit - 1) / row_unit * row_unit;
    for (std::size_t s = 0; s < n; ++s)
      for (std::size_t axis = 0; axis < 3; ++axis)
        coordinates[axis * chunk_ + s] = points[first + std::min(s, samples_ - 1)][axis];
    for (const Instruction& instruction : instructions_) step(instruction, 0, n, 0, 0);
    const Operand& result = result_.out;
    for (std::size_t s = 0; s < samples_; ++s) out[first + s] = *(result.uniform ? result.base : result.base + s);
  }
}

}  // namespace meso::implicit
