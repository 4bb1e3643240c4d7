// SPDX-License-Identifier: Apache-2.0
#include "bands.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meso::implicit {

using expr::Op;

namespace {

constexpr std::size_t most_lines = 4;

/// A step of a band, by more than it and the sample's own step may round.
double rounded_up(double band) { return band * (1 + 8 * std::numeric_limits<double>::epsilon()); }

}  // namespace

double Band::for_root(double t) const {
  if (everywhere_) return HUGE_VAL;
  double band = 0;
  for (const Line& line : lines_) band = std::max(band, line.slope * t + line.offset);
  return band;
}

double Band::root_for(double magnitude) const {
  double root = HUGE_VAL;
  for (const Line& line : lines_) root = std::min(root, (magnitude - line.offset) / line.slope);
  return std::max(root * (1 - 1e-6), 0.0);  // rounded down: a sample is a float
}

void Band::add(Line line) {
  const auto covers = [](const Line& a, const Line& b) { return a.slope >= b.slope && a.offset >= b.offset; };
  if (std::any_of(lines_.begin(), lines_.end(), [&](const Line& l) { return covers(l, line); })) return;
  std::erase_if(lines_, [&](const Line& l) { return covers(line, l); });
  if (lines_.size() == most_lines) {  // one that is above all is good enough
    for (const Line& l : lines_) line = {std::max(line.slope, l.slope), std::max(line.offset, l.offset)};
    lines_.clear();
  }
  lines_.push_back(line);
}

void Band::add(const Band& band, double factor, double offset, Direction direction) {
  everywhere_ = everywhere_ || band.everywhere_;
  rises_ = rises_ || (direction == Direction::opposite ? band.falls_ : band.rises_) ||
           (direction == Direction::either && band.falls_);
  falls_ = falls_ || (direction == Direction::opposite ? band.rises_ : band.falls_) ||
           (direction == Direction::either && band.rises_);
  for (const Line& l : band.lines_) {
    const bool same = factor == 1 && offset == 0;
    add(same ? l : Line{rounded_up(l.slope * factor), rounded_up(l.offset * factor + offset)});
  }
}

std::vector<Band> external_bands(const Graph& graph, Graph::Id root) {
  std::vector<Band> band(graph.size()), result(graph.externals().size());
  band[root].add({1, 0});
  band[root].rises_ = true;
  const std::vector<Graph::Id> order = graph.reachable(root);
  for (auto id = order.rbegin(); id != order.rend(); ++id) {
    if (graph.is_external(*id)) result[graph[*id].leaf - 3] = band[*id];
    const auto operands = graph.operands(*id);
    using enum Band::Direction;
    const auto ask = [&](std::size_t k, double factor, double offset, Band::Direction direction) {
      band[operands[k]].add(band[*id], factor, offset, direction);
    };
    // The operand of a sum or product with a number, if it is one.
    const auto number = std::find_if(operands.begin(), operands.end(), [&](Graph::Id o) { return graph.is_number(o); });
    const double signed_c = number == operands.end() ? 0 : graph[*number].number, c = std::abs(signed_c);
    const Band::Direction of_factor = signed_c < 0 ? opposite : same;
    const std::size_t other = number == operands.begin() ? 1 : 0;
    switch (graph[*id].op) {
      case Op::min:
      case Op::max:
        ask(0, 1, 0, same);
        ask(1, 1, 0, same);
        continue;
      case Op::negate:
        ask(0, 1, 0, opposite);
        continue;
      case Op::abs:
        ask(0, 1, 0, either);
        continue;
      case Op::select:
        band[operands[0]].everywhere_ = true;
        ask(1, 1, 0, same);
        ask(2, 1, 0, same);
        continue;
      case Op::add:
      case Op::subtract:
        if (number == operands.end()) break;
        ask(other, 1, c, graph[*id].op == Op::subtract && other == 1 ? opposite : same);
        continue;
      case Op::multiply:
        if (!(c > 0)) break;
        ask(other, 1 / c, 0, of_factor);
        continue;
      case Op::divide:
        if (!(c > 0) || other != 0) break;
        ask(0, c, 0, of_factor);
        continue;
      default:
        break;
    }
    for (const Graph::Id operand : operands) band[operand].everywhere_ = true;
  }
  return result;
}

}  // namespace meso::implicit
