// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where every node of a graph is computed on a grid: once per axis, once per (x, y), once per plane, or in every row.
//
//   node of       lies in                            computed
//   nothing       a number                           never
//   x, y or z     a table along that axis            once
//   x and y       a table, if it is dear and fits    once; otherwise in every row
//   x and z       a row, kept for a plane            once per plane
//   y and z       a column, kept for a plane         once per plane
//   x, y and z    a row in the first-level cache     in every row

#include <cstdint>
#include <vector>

#include "program.hpp"

namespace meso::implicit {

class Plan {
 public:
  Plan(Graph graph, Graph::Id root, const Grid& grid, const RowKernels& kernels, std::uint64_t max_table_bytes);
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  [[nodiscard]] const Graph& graph() const { return graph_; }
  [[nodiscard]] Graph::Id root() const { return root_; }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const RowKernels& kernels() const { return kernels_; }

  /// xy_step: what only tables over x and y come from, once they are filled.
  enum class Where : std::uint8_t { number, x_table, y_table, z_table, xy_table, xz_row, yz_column, step, xy_step };
  [[nodiscard]] Where where(Graph::Id id) const { return places_[id].where; }
  /// Nodes that lie there, operands first.
  [[nodiscard]] std::vector<Graph::Id> nodes(Where where) const;
  /// A value per node of the axis; over x and y, a row of padded(nodes[0]) for each y. REQUIRES: where(id) is a table.
  [[nodiscard]] const double* table(Graph::Id id) const { return tables_.data() + places_[id].offset; }

  [[nodiscard]] std::uint64_t table_bytes() const { return table_size_ * sizeof(double); }

  /// What a thread keeps for the plane it is in: doubles that the programs below need.
  [[nodiscard]] std::size_t plane_size() const { return plane_size_; }
  [[nodiscard]] Program plane_rows(double* plane) const;
  [[nodiscard]] Program plane_columns(double* plane) const;
  /// `steps`: nodes of Where::step, all of them or those that are left if nodes stand for others.
  [[nodiscard]] Program rows(std::span<const Graph::Id> steps, double* plane, const ExternalInputs& externals,
                             std::span<const Graph::Id> stands_for = {}) const;
  [[nodiscard]] Program points() const;

 private:
  struct Place {
    Where where = Where::step;
    std::size_t offset = 0;
  };
  void place_nodes(std::uint64_t max_table_bytes);
  void set_aside_xy_steps();
  void fill_tables();
  [[nodiscard]] std::vector<bool> nodes_worth_a_table() const;
  [[nodiscard]] std::optional<Operand> operand(Graph::Id id, std::size_t run_axis, double* plane) const;
  [[nodiscard]] Program::PlaceOf places(std::size_t run_axis, double* plane) const;

  Graph graph_;
  Graph::Id root_;
  Grid grid_;
  const RowKernels& kernels_;
  std::vector<Graph::Id> order_;
  std::vector<Place> places_;
  std::vector<double> numbers_;
  AlignedArray tables_;
  std::size_t table_size_ = 0, plane_size_ = 0;
};

}  // namespace meso::implicit
