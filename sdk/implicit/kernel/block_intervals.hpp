// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which values the nodes of a plan take in blocks of samples: what shows that a block is empty or full.
//
//   BlockIntervals intervals(plan);
//   intervals.enter_slab(0, 8);
//   intervals.enter_blocks_of_row(3);              // y samples 48 ... 63
//   intervals.of_block(5).all_outside();           // x samples 80 ... 95, planes 0 ... 7
//
// A block's interval includes the samples next to it on every side, so that where it is of one sign no edge of the grid
// that has an end in the block changes sign. Values of functions of one axis are those of their tables, so the
// intervals hold for the samples as they are computed; between samples they need not hold.

#include <vector>

#include "meso/implicit/interval.hpp"
#include "plan.hpp"

namespace meso::implicit {

class BlockIntervals {
 public:
  static constexpr std::int32_t side = 16;  ///< samples, along x and y; along z a block is as long as the slab

  explicit BlockIntervals(const Plan& plan);

  void enter_slab(std::int32_t first, std::int32_t last);
  void enter_blocks_of_row(std::size_t y_block);
  /// Of the root, with everything that it needs; less exactly where the root has one sign.
  const Interval& of_block(std::size_t x_block);
  /// In the block at hand. REQUIRES: a node that the root needs.
  [[nodiscard]] const Interval& operator[](Graph::Id id) const { return intervals_[id]; }

  [[nodiscard]] std::size_t x_blocks() const { return blocks(0); }
  [[nodiscard]] std::size_t y_blocks() const { return blocks(1); }

 private:
  using Nodes = std::vector<Graph::Id>;

  [[nodiscard]] std::size_t blocks(std::size_t axis) const;
  /// Per block the interval of each of the nodes, which are tables along the axis.
  [[nodiscard]] std::vector<Interval> table_intervals(const Nodes& nodes, std::size_t axis) const;
  [[nodiscard]] std::vector<Interval> xy_intervals() const;
  [[nodiscard]] Interval of_operation(Graph::Id id) const;
  [[nodiscard]] Interval of_external(Graph::Id id) const;
  void set_range(std::size_t axis, std::int32_t first, std::int32_t last);
  void load(const Nodes& nodes, const std::vector<Interval>& table, std::size_t block);

  const Plan& plan_;
  const Graph& graph_;
  Nodes x_nodes_, y_nodes_, z_nodes_, xz_nodes_, yz_nodes_, xy_nodes_, other_nodes_;
  Nodes on_externals_;  ///< of the others those that are external fields or come from such
  bool asks_externals_ = true;
  std::vector<Interval> x_table_, y_table_, xz_table_, xy_table_;  ///< block by block
  std::size_t xy_first_ = 0;                                       ///< block of xy_table_ that the row begins with
  std::vector<Interval> intervals_;                                ///< by node
  Box3 box_;                                                       ///< of the block at hand
};

}  // namespace meso::implicit
