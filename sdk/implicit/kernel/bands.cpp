// SPDX-License-Identifier: Apache-2.0
#include "bands.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit {

using expr::Op;

std::vector<double> external_bands(const Graph& graph, Graph::Id root) {
  std::vector<double> band(graph.size(), 0), result(graph.externals().size(), 0);
  const std::vector<Graph::Id> order = graph.reachable(root);
  for (auto id = order.rbegin(); id != order.rend(); ++id) {
    if (graph.is_external(*id)) result[graph[*id].leaf - 3] = band[*id];
    const auto operands = graph.operands(*id);
    const auto ask = [&](std::size_t k, double b) { band[operands[k]] = std::max(band[operands[k]], b); };
    // The operand of a sum or product with a number, if it is one.
    const auto number = std::find_if(operands.begin(), operands.end(), [&](Graph::Id o) { return graph.is_number(o); });
    const double c = number == operands.end() ? 0 : std::abs(graph[*number].number);
    const std::size_t other = number == operands.begin() ? 1 : 0;
    switch (graph[*id].op) {
      case Op::min:
      case Op::max:
        ask(1, band[*id]);
        [[fallthrough]];
      case Op::negate:
      case Op::abs:
        ask(0, band[*id]);
        continue;
      case Op::select:
        ask(0, HUGE_VAL);
        ask(1, band[*id]);
        ask(2, band[*id]);
        continue;
      case Op::add:
      case Op::subtract:
        if (number == operands.end()) break;
        ask(other, band[*id] + c);
        continue;
      case Op::multiply:
        if (c == 0) break;
        ask(other, band[*id] / c);
        continue;
      case Op::divide:
        if (c == 0 || other != 0) break;
        ask(0, band[*id] * c);
        continue;
      default:
        break;
    }
    for (std::size_t k = 0; k < operands.size(); ++k) ask(k, HUGE_VAL);
  }
  return result;
}

}  // namespace meso::implicit
