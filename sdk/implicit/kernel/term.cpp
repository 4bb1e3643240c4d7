// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/term.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

#include "meso/implicit/flat_term.hpp"
#include "scalar_operation.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

/// The terms at the coordinates of source_from_target p.
std::array<Term, 3> rows_of(const Affine& source_from_target) {
  std::array<Term, 3> rows;
  for (std::size_t row = 0; row < 3; ++row) {
    Term sum = Term::constant(source_from_target.translation[row]);
    for (std::size_t column = 3; column-- > 0;) {
      const double factor = source_from_target.linear(row, column);
      if (factor == 0) continue;
      const Term coordinate = Term::coordinate(column);
      const Term product = factor == 1 ? coordinate : factor * coordinate;
      sum = sum.is_constant() && sum.node().number == 0 ? product : product + sum;
    }
    rows[row] = sum;
  }
  return rows;
}

/// The same operations on other coordinates; shared nodes stay shared.
template <class External>
Term rebuilt(const Term& term, const std::array<Term, 3>& coordinates, const External& external) {
  const FlatTerm flat(term);
  std::vector<Term> made;
  made.reserve(flat.steps().size());
  for (const FlatTerm::Step& step : flat.steps()) {
    const TermNode& n = *step.node;
    if (n.op == Op::number) {
      made.push_back(Term::constant(n.number));
    } else if (n.op == Op::name) {
      made.push_back(n.axis == TermNode::external_axis ? external(n) : coordinates[n.axis]);
    } else {
      std::vector<Term> operands;
      for (const std::uint32_t index : flat.operands(step)) operands.push_back(made[index]);
      made.push_back(Term::apply(n.op, std::move(operands)));
    }
  }
  return made.back();
}

}  // namespace

Term Term::constant(double value) {
  return Term(std::make_shared<TermNode>(TermNode{.op = Op::number, .number = value}));
}

Term Term::coordinate(std::size_t axis) {
  assert(axis < 3);
  return Term(std::make_shared<TermNode>(TermNode{.op = Op::name, .axis = static_cast<std::uint32_t>(axis)}));
}

Term Term::external(std::shared_ptr<const ExternalField> field, const Affine& field_from_world) {
  return Term(std::make_shared<TermNode>(TermNode{.op = Op::name,
                                                  .axis = TermNode::external_axis,
                                                  .external = std::move(field),
                                                  .field_from_world = field_from_world}));
}

Term Term::apply(Op op, std::vector<Term> operands) {
  assert(!operands.empty() && operands.size() <= 8);
  bool constant_operands = true;
  std::array<double, 8> values{};
  for (std::size_t i = 0; i < operands.size(); ++i) {
    constant_operands = constant_operands && operands[i].is_constant();
    values[i] = operands[i].node().number;
  }
  if (constant_operands) return constant(apply_operation(op, {values.data(), operands.size()}));
  const auto node = std::make_shared<TermNode>();
  node->op = op;
  node->operands = std::move(operands);
  return Term(node);
}

Term Term::from_expression(const expr::Expression& expression, std::span<const Term> term_of_name) {
  std::vector<std::size_t> name_of_slot;
  for (std::size_t k = 0; k < expression.names().size(); ++k) {
    const std::size_t slot = expression.names()[k].slot;
    if (slot >= name_of_slot.size()) name_of_slot.resize(slot + 1);
    name_of_slot[slot] = k;
  }
  std::vector<Term> stack;
  for (const expr::Node& node : expression.nodes()) {
    switch (node.op) {
      case Op::skip_if_zero:
      case Op::skip:
      case Op::and_skip:
      case Op::or_skip:
        break;
      case Op::number:
        stack.push_back(constant(node.number));
        break;
      case Op::name:
        stack.push_back(term_of_name[name_of_slot[node.index]]);
        break;
      default: {
        std::vector<Term> operands(stack.end() - node.operands, stack.end());
        stack.resize(stack.size() - node.operands);
        stack.push_back(apply(node.op, std::move(operands)));
      }
    }
  }
  assert(stack.size() == 1);
  return stack.back();
}

Term Term::at(const Affine& source_from_target) const {
  return rebuilt(*this, rows_of(source_from_target), [&](const TermNode& leaf) {
    return external(leaf.external, leaf.field_from_world * source_from_target);
  });
}

Term Term::with(const std::array<Term, 3>& xyz) const {
  assert(!has_external());
  return rebuilt(*this, xyz, [](const TermNode&) { return Term(); });
}

bool Term::has_external() const {
  const FlatTerm flat(*this);
  return std::ranges::any_of(flat.steps(), [](const FlatTerm::Step& step) {
    return step.node->op == Op::name && step.node->axis == TermNode::external_axis;
  });
}

double Term::value(Vec3 p) const { return FlatTerm(*this).value(p); }

// A chain of a hundred thousand operations must not be destroyed by as many nested calls.
TermNode::~TermNode() {
  std::vector<Term> doomed = std::move(operands);
  while (!doomed.empty()) {
    const Term term = std::move(doomed.back());
    doomed.pop_back();
    if (!term.is_last_owner()) continue;
    // The node was made by make_shared<TermNode>, and nobody else can see it any more.
    auto& orphans = const_cast<TermNode&>(term.node()).operands;
    doomed.insert(doomed.end(), std::make_move_iterator(orphans.begin()), std::make_move_iterator(orphans.end()));
    orphans.clear();
  }
}

Term operator+(const Term& a, const Term& b) { return Term::apply(Op::add, {a, b}); }
Term operator-(const Term& a, const Term& b) { return Term::apply(Op::subtract, {a, b}); }
Term operator*(const Term& a, const Term& b) { return Term::apply(Op::multiply, {a, b}); }
Term operator/(const Term& a, const Term& b) { return Term::apply(Op::divide, {a, b}); }
Term operator-(const Term& a) { return Term::apply(Op::negate, {a}); }
Term min(const Term& a, const Term& b) { return Term::apply(Op::min, {a, b}); }
Term max(const Term& a, const Term& b) { return Term::apply(Op::max, {a, b}); }
Term abs(const Term& a) { return Term::apply(Op::abs, {a}); }
Term sqrt(const Term& a) { return Term::apply(Op::sqrt, {a}); }

}  // namespace meso::implicit
