// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/shortest_period.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "meso/sdf/solid_tree.hpp"

namespace meso::sdf {
namespace {

using Repeats = std::optional<Period>;

Repeats shorter(const Repeats& a, const Repeats& b) { return !a || (b && b->length < a->length) ? b : a; }

Repeats changed(Repeats period, const Instruction& instruction) {
  const auto& n = instruction.numbers;
  switch (instruction.verb) {
    case Verb::scale:
      if (period) period->length *= std::min({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
      return period;
    case Verb::repeat:
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (n[axis] > 0) period = shorter(period, Period{&instruction, n[axis]});
      return period;
    case Verb::cylindrical:
    case Verb::spherical:
    case Verb::helix:
      return std::nullopt;
    default:
      return period;
  }
}

}  // namespace

std::optional<Period> shortest_period(const Program& program) {
  const SolidTree tree = solid_tree(program);
  std::vector<Repeats> solids;
  for (const SolidTree::Node& node : tree.nodes) {
    const Verb verb = node.made_by->verb;
    Repeats made;
    if (node.of.empty() && (verb == Verb::surface || verb == Verb::strut)) made = Period{node.made_by, 1};
    if (node.of.size() == 1) made = changed(solids[node.of[0]], *node.made_by);
    if (node.of.size() == 2) made = shorter(solids[node.of[0]], solids[node.of[1]]);
    solids.push_back(made);
  }
  return solids.back();
}

}  // namespace meso::sdf
