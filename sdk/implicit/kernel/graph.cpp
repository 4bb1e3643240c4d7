// SPDX-License-Identifier: Apache-2.0
#include "graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "meso/implicit/flat_term.hpp"
#include "scalar_operation.hpp"

namespace meso::implicit {

using expr::Op;

Graph::Id Graph::intern(Key key, Node node) {
  const auto [place, is_new] = known_.try_emplace(std::move(key), static_cast<Id>(nodes_.size()));
  if (is_new) {
    node.op = place->first.op;
    node.first_operand = static_cast<std::uint32_t>(operands_.size());
    node.operands = static_cast<std::uint32_t>(place->first.operands.size());
    for (const Id operand : place->first.operands) {
      operands_.push_back(operand);
      node.axes |= nodes_[operand].axes;
    }
    nodes_.push_back(node);
  }
  return place->second;
}

Graph::Id Graph::number(double value) {
  return intern({Op::number, std::bit_cast<std::uint64_t>(value), {}}, {.number = value});
}

Graph::Id Graph::coordinate(std::uint32_t axis) {
  return intern({Op::name, axis, {}}, {.axes = static_cast<Axes>(1U << axis), .leaf = axis});
}

Graph::Id Graph::external(const TermNode& leaf) {
  const auto same = std::find_if(externals_.begin(), externals_.end(), [&](const ExternalLeaf& e) {
    return e.field == leaf.external && e.field_from_world == leaf.field_from_world;
  });
  const auto id = static_cast<std::uint32_t>(3 + (same - externals_.begin()));
  if (same == externals_.end()) externals_.push_back({leaf.external, leaf.field_from_world});
  return intern({Op::name, id, {}}, {.axes = all_axes, .leaf = id});
}

/// Products are within the 4 ulp that a power may be off up to the exponent 4; a division more for negative ones.
Graph::Id Graph::power(Id base, double exponent) {
  if (exponent < 0) return apply(Op::divide, {number(1), power(base, -exponent)});
  const Id square = apply(Op::multiply, {base, base});
  if (exponent == 1) return base;
  if (exponent == 2) return square;
  return exponent == 3 ? apply(Op::multiply, {square, base}) : apply(Op::multiply, {square, square});
}

Graph::Id Graph::apply(Op op, std::span<const Id> operands) {
  if (op != sum_of_products && std::all_of(operands.begin(), operands.end(), [&](Id id) { return is_number(id); })) {
    std::vector<double> constants;
    for (const Id id : operands) constants.push_back(nodes_[id].number);
    return number(apply_operation(op, constants));
  }
  const auto is = [&](std::size_t k, double value) {
    return is_number(operands[k]) && nodes_[operands[k]].number == value;
  };
  std::vector<Id> ordered(operands.begin(), operands.end());
  switch (op) {
    case Op::multiply:
      if (is(0, 1)) return operands[1];
      if (is(1, 1)) return operands[0];
      std::sort(ordered.begin(), ordered.end());
      break;
    case Op::add:
      std::sort(ordered.begin(), ordered.end());
      break;
    case Op::divide:
      if (is(1, 1)) return operands[0];
      if (is_number(operands[1])) {  // by a power of two: the product is the same to the bit, and cheaper
        const double divisor = nodes_[operands[1]].number;
        int exponent = 0;
        if (std::abs(std::frexp(divisor, &exponent)) == 0.5 && std::abs(exponent) < 1000)
          return apply(Op::multiply, {operands[0], number(1 / divisor)});
      }
      break;
    case Op::power:
      for (const double exponent : {1., 2., 3., 4., -1., -2.})
        if (is(1, exponent)) return power(operands[0], exponent);
      if (is(1, 0)) return number(1);
      break;
    case Op::clamp:  // its definition
      return apply(Op::min, {apply(Op::max, {ordered[0], ordered[1]}), ordered[2]});
    case Op::negate:
      if (nodes_[operands[0]].op == Op::negate) return this->operands(operands[0])[0];
      break;
    default:
      break;
  }
  return intern({op, 0, std::move(ordered)}, {});
}

Graph::Id Graph::from_term(const Term& term) {
  const FlatTerm flat(term);
  std::vector<Id> ids, operands;
  for (const FlatTerm::Step& step : flat.steps()) {
    if (step.op == Op::number) {
      ids.push_back(number(step.node->number));
    } else if (step.op == Op::name) {
      ids.push_back(step.node->axis == TermNode::external_axis ? external(*step.node) : coordinate(step.node->axis));
    } else {
      operands.clear();
      for (const std::uint32_t operand : flat.operands(step)) operands.push_back(ids[operand]);
      ids.push_back(apply(step.op, operands));
    }
  }
  return ids.back();
}

std::vector<Graph::Id> Graph::reachable(Id root) const {
  std::vector<bool> needed(nodes_.size());
  needed[root] = true;
  for (Id id = root + 1; id-- > 0;)
    if (needed[id])
      for (const Id operand : operands(id)) needed[operand] = true;
  std::vector<Id> result;
  for (Id id = 0; id <= root; ++id)
    if (needed[id]) result.push_back(id);
  return result;
}

}  // namespace meso::implicit
