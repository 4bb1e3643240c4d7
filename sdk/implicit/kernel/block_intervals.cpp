// SPDX-License-Identifier: Apache-2.0
#include "block_intervals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "meso/implicit/interval_arithmetic.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

/// Of no value yet.
constexpr Interval nothing{HUGE_VAL, -HUGE_VAL, false};

void extend(Interval& r, const double* values, std::int32_t first, std::int32_t last) {
  for (std::int32_t i = first; i < last; ++i) {
    r.lo = std::min(r.lo, values[i]);  // a NaN changes neither
    r.hi = std::max(r.hi, values[i]);
    r.undefined = r.undefined || std::isnan(values[i]);
  }
}

Interval settled(const Interval& r) { return r.lo <= r.hi ? r : Interval{0, 0, true}; }

Interval range_of(const double* values, std::int32_t first, std::int32_t last) {
  Interval r = nothing;
  extend(r, values, first, last);
  return settled(r);
}

/// Rounded like the samples themselves, in the same order: rounding never decreases, so no sample can leave it.
Interval product_of_rounded(const Interval& a, const Interval& b) {
  const std::array<double, 4> corners = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  if (!std::isfinite(corners[0] + corners[1] + corners[2] + corners[3])) return Interval::everything();
  const auto [lo, hi] = std::minmax_element(corners.begin(), corners.end());
  return {*lo, *hi, a.undefined || b.undefined};
}

}  // namespace

BlockIntervals::BlockIntervals(const Plan& plan)
    : plan_(plan),
      graph_(plan.graph()),
      x_nodes_(plan.nodes(Plan::Where::x_table)),
      y_nodes_(plan.nodes(Plan::Where::y_table)),
      z_nodes_(plan.nodes(Plan::Where::z_table)),
      xz_nodes_(plan.nodes(Plan::Where::xz_row)),
      yz_nodes_(plan.nodes(Plan::Where::yz_column)),
      xy_nodes_(plan.nodes(Plan::Where::xy_table)),
      x_table_(table_intervals(x_nodes_, 0)),
      y_table_(table_intervals(y_nodes_, 1)),
      xy_table_(xy_intervals()),
      intervals_(graph_.size()) {
  for (const Graph::Id id : graph_.reachable(plan.root())) {
    const Plan::Where where = plan.where(id);
    if (where == Plan::Where::number) {
      const double v = graph_[id].number;
      intervals_[id] = std::isnan(v) ? Interval{0, 0, true} : Interval{v, v, false};
    } else if (where == Plan::Where::step) {
      other_nodes_.push_back(id);
    }
  }
  std::vector<bool> depends(graph_.size());
  for (const Graph::Id id : other_nodes_) {
    const auto operands = graph_.operands(id);
    depends[id] = graph_.is_external(id) ||
                  std::any_of(operands.begin(), operands.end(), [&](Graph::Id o) { return depends[o]; });
    if (depends[id]) on_externals_.push_back(id);
  }
}

std::size_t BlockIntervals::blocks(std::size_t axis) const {
  return static_cast<std::size_t>((plan_.grid().nodes[axis] + side - 1) / side);
}

std::vector<Interval> BlockIntervals::table_intervals(const Nodes& nodes, std::size_t axis) const {
  std::vector<Interval> result;
  for (std::int32_t block = 0; block < static_cast<std::int32_t>(blocks(axis)); ++block)
    for (const Graph::Id id : nodes)
      result.push_back(range_of(plan_.table(id), std::max(0, block * side - 1),
                                std::min(plan_.grid().nodes[axis], (block + 1) * side + 1)));
  return result;
}

std::vector<Interval> BlockIntervals::xy_intervals() const {
  const std::int32_t nx = plan_.grid().nodes[0], ny = plan_.grid().nodes[1];
  const std::size_t row = padded(static_cast<std::size_t>(nx));
  std::vector<Interval> result;
  for (std::int32_t y = 0; y < ny && !xy_nodes_.empty(); y += side)
    for (std::int32_t x = 0; x < nx; x += side)
      for (const Graph::Id id : xy_nodes_) {
        Interval r = nothing;
        for (std::int32_t j = std::max(0, y - 1); j < std::min(ny, y + side + 1); ++j)
          extend(r, plan_.table(id) + static_cast<std::size_t>(j) * row, std::max(0, x - 1),
                 std::min(nx, x + side + 1));
        result.push_back(settled(r));
      }
  return result;
}

void BlockIntervals::set_range(std::size_t axis, std::int32_t first, std::int32_t last) {
  box_.min[axis] = plan_.grid().coordinate(axis, std::max(0, first - 1));
  box_.max[axis] = plan_.grid().coordinate(axis, std::min(plan_.grid().nodes[axis] - 1, last));
}

void BlockIntervals::load(const Nodes& nodes, const std::vector<Interval>& table, std::size_t block) {
  for (std::size_t n = 0; n < nodes.size(); ++n) intervals_[nodes[n]] = table[block * nodes.size() + n];
}

void BlockIntervals::enter_slab(std::int32_t first, std::int32_t last) {
  set_range(2, first, last);
  for (const Graph::Id id : z_nodes_)
    intervals_[id] = range_of(plan_.table(id), std::max(0, first - 1), std::min(plan_.grid().nodes[2], last + 1));
  xz_table_.clear();
  for (std::size_t block = 0; block < x_blocks() && !xz_nodes_.empty(); ++block) {
    load(x_nodes_, x_table_, block);
    for (const Graph::Id id : xz_nodes_) xz_table_.push_back(intervals_[id] = of_operation(id));
  }
}

void BlockIntervals::enter_blocks_of_row(std::size_t y_block) {
  const auto j = static_cast<std::int32_t>(y_block) * side;
  set_range(1, j, j + side);
  load(y_nodes_, y_table_, y_block);
  for (const Graph::Id id : yz_nodes_) intervals_[id] = of_operation(id);
  xy_first_ = y_block * x_blocks();
}

const Interval& BlockIntervals::of_block(std::size_t x_block) {
  const auto i = static_cast<std::int32_t>(x_block) * side;
  set_range(0, i, i + side);
  load(x_nodes_, x_table_, x_block);
  load(xz_nodes_, xz_table_, x_block);
  load(xy_nodes_, xy_table_, xy_first_ + x_block);
  // An external's interval is dear, and often the rest of the field tells the sign whatever it is.
  const Interval& root = intervals_[plan_.root()];
  asks_externals_ = false;
  for (const Graph::Id id : other_nodes_) intervals_[id] = of_operation(id);
  if (on_externals_.empty() || root.all_inside() || root.all_outside()) return root;
  asks_externals_ = true;
  for (const Graph::Id id : on_externals_) intervals_[id] = of_operation(id);
  return root;
}

Interval BlockIntervals::of_operation(Graph::Id id) const {
  if (graph_.is_external(id)) return asks_externals_ ? of_external(id) : Interval::everything();
  const auto operands = graph_.operands(id);
  if (graph_[id].op == sum_of_products) {
    Interval sum = intervals_[operands[0]];
    for (std::size_t k = 1; k + 1 < operands.size(); k += 2) {
      const Interval product = product_of_rounded(intervals_[operands[k]], intervals_[operands[k + 1]]);
      sum = {sum.lo + product.lo, sum.hi + product.hi, sum.undefined || product.undefined};
    }
    return std::isfinite(sum.lo) && std::isfinite(sum.hi) ? sum : Interval::everything();
  }
  if (graph_[id].op == Op::multiply && operands[0] == operands[1]) return square(intervals_[operands[0]]);
  std::array<Interval, 8> of_operands{};
  for (std::size_t k = 0; k < operands.size(); ++k) of_operands[k] = intervals_[operands[k]];
  return interval_of(graph_[id].op, {of_operands.data(), operands.size()});
}

Interval BlockIntervals::of_external(Graph::Id id) const {
  const ExternalLeaf& leaf = graph_.externals()[graph_[id].leaf - 3];
  Box3 box;
  for (unsigned corner = 0; corner < 8; ++corner)
    box.extend(leaf.field_from_world * Vec3{corner & 1 ? box_.max.x : box_.min.x, corner & 2 ? box_.max.y : box_.min.y,
                                            corner & 4 ? box_.max.z : box_.min.z});
  return leaf.field->interval(box);
}

}  // namespace meso::implicit
