// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/grid_interpolation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace meso::fields {
namespace {

constexpr double node_tolerance = 1e-12;  // of a step: what a coordinate loses on its way through P and back

}  // namespace

GridInterpolation::GridInterpolation(std::vector<std::vector<double>> axes)
    : axes_(std::move(axes)), step_(axes_.size(), 1) {
  assert(!axes_.empty() && axes_.size() <= most_grid_axes);
  for (std::size_t a = axes_.size() - 1; a > 0; --a)
    step_[a - 1] = step_[a] * static_cast<std::int64_t>(axes_[a].size());
}

bool GridInterpolation::contains(std::span<const double> q) const {
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const std::vector<double>& nodes = axes_[a];
    if (nodes.size() == 1) continue;
    const double below = node_tolerance * (nodes[1] - nodes[0]);
    const double above = node_tolerance * (nodes.back() - nodes[nodes.size() - 2]);
    if (!(q[a] >= nodes.front() - below && q[a] <= nodes.back() + above)) return false;
  }
  return true;
}

GridInterpolation::Place GridInterpolation::place(std::size_t axis, double q) const {
  const std::vector<double>& nodes = axes_[axis];
  if (nodes.size() == 1) return {};
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, q);
  const auto node = static_cast<std::size_t>(above - nodes.begin()) - 1;
  const double t = std::clamp((q - nodes[node]) / (nodes[node + 1] - nodes[node]), 0.0, 1.0);
  return {node, t < node_tolerance ? 0 : t > 1 - node_tolerance ? 1 : t};
}

Stencil GridInterpolation::at(std::span<const double> q) const {
  assert(q.size() == axes_.size());
  std::array<Place, most_grid_axes> places;
  for (std::size_t a = 0; a < axes_.size(); ++a) places[a] = place(a, q[a]);
  Stencil stencil;
  for (std::size_t corner = 0; corner < std::size_t{1} << axes_.size(); ++corner) {
    std::int64_t record = 0;
    double weight = 1;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const bool is_upper = (corner >> (axes_.size() - 1 - a) & 1) != 0;
      record += step_[a] * static_cast<std::int64_t>(places[a].node + (is_upper ? 1 : 0));
      weight *= is_upper ? places[a].fraction : 1 - places[a].fraction;
    }
    stencil.add(record, weight);
  }
  return stencil;
}

std::array<double, most_grid_axes> GridInterpolation::derivative(const Records& records, std::size_t column,
                                                                 const Stencil& stencil) const {
  std::array<double, most_grid_axes> result{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const std::vector<double>& nodes = axes_[a];
    if (nodes.size() == 1) continue;
    for (std::size_t i = 0; i < stencil.count; ++i) {
      const std::int64_t r = stencil.record[i];
      const auto n = static_cast<std::size_t>(r / step_[a]) % nodes.size();
      const auto value = [&](std::int64_t steps) {
        return records(static_cast<std::size_t>(r + steps * step_[a]), column);
      };
      double slope = 0;
      if (n == 0) {
        slope = (value(1) - value(0)) / (nodes[1] - nodes[0]);
      } else if (n + 1 == nodes.size()) {
        slope = (value(0) - value(-1)) / (nodes[n] - nodes[n - 1]);
      } else {
        const double below = nodes[n] - nodes[n - 1], above = nodes[n + 1] - nodes[n];
        slope = (below * below * (value(1) - value(0)) + above * above * (value(0) - value(-1))) /
                (below * above * (below + above));
      }
      result[a] += stencil.weight[i] * slope;
    }
  }
  return result;
}

}  // namespace meso::fields
