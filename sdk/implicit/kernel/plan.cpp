// SPDX-License-Identifier: Apache-2.0
#include "plan.hpp"

#include <algorithm>
#include <cassert>

namespace meso::implicit {

using expr::Op;

namespace {

bool is_dear(Op op) {
  switch (op) {
    case Op::divide:
    case Op::power:
    case Op::mod:
    case Op::hash:
    case Op::hypot:
    case Op::atan2:
    case Op::floor:
    case Op::ceil:
    case Op::round:
      return true;
    default:
      return op >= Op::sqrt && op <= Op::atan;
  }
}

}  // namespace

Plan::Plan(Graph graph, Graph::Id root, const Grid& grid, const RowKernels& kernels, std::uint64_t max_table_bytes)
    : graph_(std::move(graph)), root_(root), grid_(grid), kernels_(kernels), order_(graph_.reachable(root)) {
  place_nodes(max_table_bytes);
  set_aside_xy_steps();
  fill_tables();
}

/// Nodes of x and y that something of x, y and z reads (or the root), with a dear operation in them.
std::vector<bool> Plan::nodes_worth_a_table() const {
  constexpr Axes xy = x_axis | y_axis;
  std::vector<bool> dear(graph_.size()), read(graph_.size());
  for (const Graph::Id id : order_) {
    dear[id] = is_dear(graph_[id].op);
    for (const Graph::Id operand : graph_.operands(id)) {
      if (graph_[operand].axes == xy && dear[operand]) dear[id] = true;
      if (graph_[id].axes == all_axes) read[operand] = true;
    }
  }
  read[root_] = true;
  std::vector<bool> result(graph_.size());
  for (const Graph::Id id : order_) result[id] = graph_[id].axes == xy && dear[id] && read[id];
  return result;
}

void Plan::place_nodes(std::uint64_t max_table_bytes) {
  const auto length = [&](std::size_t axis) { return padded(static_cast<std::size_t>(grid_.nodes[axis])); };
  const std::vector<bool> worth = nodes_worth_a_table();
  places_.resize(graph_.size());
  const auto put = [&](Place& place, Where where, std::size_t& used, std::size_t size) {
    place = {where, used};
    used += size;
  };
  for (const Graph::Id id : order_) {
    Place& place = places_[id];
    switch (graph_[id].axes) {
      case 0:
        place = {Where::number, numbers_.size()};
        numbers_.push_back(graph_[id].number);
        break;
      case x_axis:
        put(place, Where::x_table, table_size_, length(0));
        break;
      case y_axis:
        put(place, Where::y_table, table_size_, length(1));
        break;
      case z_axis:
        put(place, Where::z_table, table_size_, length(2));
        break;
      case x_axis | z_axis:
        put(place, Where::xz_row, plane_size_, length(0));
        break;
      case y_axis | z_axis:
        put(place, Where::yz_column, plane_size_, length(1));
        break;
      default: {
        const std::uint64_t bytes = std::uint64_t{length(0)} * static_cast<std::uint64_t>(grid_.nodes[1]) * 8;
        if (!worth[id] || bytes > max_table_bytes) break;
        max_table_bytes -= bytes;
        put(place, Where::xy_table, table_size_, bytes / 8);
      }
    }
  }
}

/// What the root needs no more once the tables are there.
void Plan::set_aside_xy_steps() {
  std::vector<bool> needed(graph_.size());
  needed[root_] = true;
  for (auto id = order_.rbegin(); id != order_.rend(); ++id) {
    Place& place = places_[*id];
    if (place.where == Where::step && !needed[*id] && graph_[*id].axes == (x_axis | y_axis))
      place.where = Where::xy_step;
    else if (place.where == Where::step)
      for (const Graph::Id operand : graph_.operands(*id)) needed[operand] = true;
  }
}

std::optional<Operand> Plan::operand(Graph::Id id, std::size_t run_axis, double* plane) const {
  const Place& place = places_[id];
  double* const in_table = tables_.data() + place.offset;
  switch (place.where) {
    case Where::number:
      return Operand{.base = const_cast<double*>(numbers_.data()) + place.offset, .uniform = true};
    case Where::x_table:
      return Operand{.base = in_table, .along = 1};
    case Where::y_table:
      return run_axis == 1 ? Operand{.base = in_table, .along = 1}
                           : Operand{.base = in_table, .row = 1, .uniform = true};
    case Where::z_table:
      return run_axis == 2 ? Operand{.base = in_table, .along = 1}
                           : Operand{.base = in_table, .plane = 1, .uniform = true};
    case Where::xy_table:
      return Operand{
          .base = in_table, .along = 1, .row = static_cast<std::ptrdiff_t>(padded(std::size_t(grid_.nodes[0])))};
    case Where::xz_row:
      return Operand{.base = plane + place.offset, .along = 1};
    case Where::yz_column:
      return run_axis == 1 ? Operand{.base = plane + place.offset, .along = 1}
                           : Operand{.base = plane + place.offset, .row = 1, .uniform = true};
    case Where::step:
    case Where::xy_step:
      break;
  }
  return std::nullopt;
}

Program::PlaceOf Plan::places(std::size_t run_axis, double* plane) const {
  return [this, run_axis, plane](Graph::Id id) { return operand(id, run_axis, plane); };
}

std::vector<Graph::Id> Plan::nodes(Where where) const {
  std::vector<Graph::Id> result;
  for (const Graph::Id id : order_)
    if (places_[id].where == where) result.push_back(id);
  return result;
}

void Plan::fill_tables() {
  tables_ = AlignedArray(table_size_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(grid_.nodes[axis]);
    std::vector<Graph::Id> steps;
    for (const Graph::Id id : order_) {
      if (graph_[id].axes != 1 << axis) continue;
      if (graph_[id].op != Op::name) {
        steps.push_back(id);
        continue;
      }
      for (std::size_t i = 0; i < padded(n); ++i)
        tables_.data()[places_[id].offset + i] = grid_.coordinate(axis, static_cast<std::int32_t>(std::min(i, n - 1)));
    }
    if (!steps.empty()) Program(graph_, kernels_, steps, steps.back(), places(axis, nullptr)).run(0, padded(n), 0, 0);
  }
  const std::vector<Graph::Id> xy_tables = nodes(Where::xy_table);
  if (xy_tables.empty()) return;
  std::vector<bool> needed(graph_.size());
  for (Graph::Id id = xy_tables.back() + 1; id-- > 0;) {
    if (places_[id].where == Where::xy_table) needed[id] = true;
    if (needed[id])
      for (const Graph::Id operand : graph_.operands(id)) needed[operand] = true;
  }
  std::vector<Graph::Id> steps;
  for (const Graph::Id id : order_)
    if (needed[id] && graph_[id].axes == (x_axis | y_axis)) steps.push_back(id);
  Program program(graph_, kernels_, steps, steps.back(), places(0, nullptr));
  for (std::size_t j = 0; j < static_cast<std::size_t>(grid_.nodes[1]); ++j)
    program.run(0, padded(static_cast<std::size_t>(grid_.nodes[0])), j, 0);
}

Program Plan::plane_rows(double* plane) const {
  return {graph_, kernels_, nodes(Where::xz_row), root_, places(0, plane)};
}
Program Plan::plane_columns(double* plane) const {
  return {graph_, kernels_, nodes(Where::yz_column), root_, places(1, plane)};
}
Program Plan::rows(std::span<const Graph::Id> steps, double* plane, const ExternalInputs& externals,
                   std::span<const Graph::Id> stands_for) const {
  return {graph_, kernels_, steps, root_, places(0, plane), externals, stands_for};
}

Program Plan::points() const {
  std::vector<Graph::Id> steps;
  for (const Graph::Id id : order_)
    if (graph_[id].axes != 0 && (graph_[id].op != Op::name || graph_.is_external(id))) steps.push_back(id);
  return {graph_, kernels_, steps, root_,
          [this](Graph::Id id) { return graph_[id].axes == 0 ? operand(id, 0, nullptr) : std::nullopt; }};
}

}  // namespace meso::implicit
