// SPDX-License-Identifier: Apache-2.0
#pragma once
// What of a slab has to be computed, and by which program: blocks of one sign are skipped, and where min, max or a
// condition can only go one way the other way is left out.

#include <map>
#include <memory>
#include <vector>

#include "block_intervals.hpp"

namespace meso::implicit {

/// A program for the steps that are left when nodes stand for others.
using MakeProgram =
    std::function<std::unique_ptr<Program>(std::span<const Graph::Id> steps, std::span<const Graph::Id> stands_for)>;

/// A row's samples begin ... end - 1, both multiples of row_unit.
struct Run {
  std::size_t begin = 0, end = 0;
  Program* program = nullptr;
};

/// For the rows of a block: bits of 16 samples each, right outside the runs, and what is computed.
struct RowPlan {
  std::vector<std::uint16_t> inside;
  std::vector<Run> runs;
};

class SlabPlan {
 public:
  SlabPlan(const Plan& plan, MakeProgram make_program);

  void enter_slab(std::int32_t first, std::int32_t last);
  [[nodiscard]] const RowPlan& of_row(std::int32_t j) const {
    return rows_[static_cast<std::size_t>(j / BlockIntervals::side)];
  }

 private:
  void plan_row(RowPlan& row);
  /// For the block at hand.
  Program* program();
  void find_choices();

  const Plan& plan_;
  MakeProgram make_program_;
  BlockIntervals intervals_;
  std::vector<Graph::Id> steps_;
  std::vector<Graph::Id> choosing_;    ///< steps that are min, max or select
  std::vector<Graph::Id> stands_for_;  ///< in the block at hand; all nodes
  std::vector<bool> needed_, read_;    ///< likewise: as a step; as it stands in the graph
  std::map<std::vector<Graph::Id>, std::unique_ptr<Program>> programs_;  ///< by steps, then what each choice comes to
  std::unique_ptr<Program> full_program_;
  std::vector<RowPlan> rows_;  ///< by block of y
};

/// Whether skipping gains more than it costs, from blocks here and there of slabs of this many planes.
[[nodiscard]] bool pruning_pays(const Plan& plan, std::int32_t slab);

}  // namespace meso::implicit
