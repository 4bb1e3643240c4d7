// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/term.hpp"

#include <cassert>
#include <unordered_map>

#include "meso/expr/operations.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

double apply_one(Op op, std::span<const double> v) {
  switch (op) {
    case Op::negate:
      return expr::apply<Op::negate>(v[0]);
    case Op::logical_not:
      return expr::apply<Op::logical_not>(v[0]);
    case Op::floor:
      return expr::apply<Op::floor>(v[0]);
    case Op::ceil:
      return expr::apply<Op::ceil>(v[0]);
    case Op::round:
      return expr::apply<Op::round>(v[0]);
    case Op::abs:
      return expr::apply<Op::abs>(v[0]);
    case Op::sign:
      return expr::apply<Op::sign>(v[0]);
    case Op::sqrt:
      return expr::apply<Op::sqrt>(v[0]);
    case Op::exp:
      return expr::apply<Op::exp>(v[0]);
    case Op::log:
      return expr::apply<Op::log>(v[0]);
    case Op::sin:
      return expr::apply<Op::sin>(v[0]);
    case Op::cos:
      return expr::apply<Op::cos>(v[0]);
    case Op::tan:
      return expr::apply<Op::tan>(v[0]);
    case Op::asin:
      return expr::apply<Op::asin>(v[0]);
    case Op::acos:
      return expr::apply<Op::acos>(v[0]);
    case Op::atan:
      return expr::apply<Op::atan>(v[0]);
    case Op::add:
      return expr::apply<Op::add>(v[0], v[1]);
    case Op::subtract:
      return expr::apply<Op::subtract>(v[0], v[1]);
    case Op::multiply:
      return expr::apply<Op::multiply>(v[0], v[1]);
    case Op::divide:
      return expr::apply<Op::divide>(v[0], v[1]);
    case Op::power:
      return expr::apply<Op::power>(v[0], v[1]);
    case Op::less:
      return expr::apply<Op::less>(v[0], v[1]);
    case Op::less_equal:
      return expr::apply<Op::less_equal>(v[0], v[1]);
    case Op::greater:
      return expr::apply<Op::greater>(v[0], v[1]);
    case Op::greater_equal:
      return expr::apply<Op::greater_equal>(v[0], v[1]);
    case Op::equal:
      return expr::apply<Op::equal>(v[0], v[1]);
    case Op::not_equal:
      return expr::apply<Op::not_equal>(v[0], v[1]);
    case Op::mod:
      return expr::apply<Op::mod>(v[0], v[1]);
    case Op::atan2:
      return expr::apply<Op::atan2>(v[0], v[1]);
    case Op::hypot:
      return expr::apply<Op::hypot>(v[0], v[1]);
    case Op::min:
      return expr::apply<Op::min>(v[0], v[1]);
    case Op::max:
      return expr::apply<Op::max>(v[0], v[1]);
    case Op::clamp:
      return expr::apply<Op::clamp>(v[0], v[1], v[2]);
    case Op::hash:
      return expr::apply_hash(v);
    case Op::logical_and:
      return v[0] != 0 && v[1] != 0 ? 1 : 0;
    case Op::logical_or:
      return v[0] != 0 || v[1] != 0 ? 1 : 0;
    case Op::select:
      return v[0] != 0 ? v[1] : v[2];
    default:
      break;
  }
  assert(!"an operation with operands");
  return 0;
}

/// Rebuilds a tree with new leaves, each shared node once.
template <class Leaf>
class Rebuild {
 public:
  explicit Rebuild(Leaf leaf) : leaf_(std::move(leaf)) {}
  Term operator()(const Term& t) {
    const auto found = done_.find(t.identity());
    if (found != done_.end()) return found->second;
    const TermNode& n = t.node();
    Term result;
    if (n.operands.empty()) {
      result = leaf_(t);
    } else {
      std::vector<Term> operands;
      for (const Term& operand : n.operands) operands.push_back((*this)(operand));
      result = Term::apply(n.op, std::move(operands));
    }
    done_.emplace(t.identity(), result);
    return result;
  }

 private:
  Leaf leaf_;
  std::unordered_map<const TermNode*, Term> done_;
};

double walk(const Term& t, Vec3 p, std::unordered_map<const TermNode*, double>& done) {
  const TermNode& n = t.node();
  if (n.op == Op::number) return n.number;
  if (n.op == Op::name)
    return n.axis == TermNode::external_axis ? n.external->value(n.field_from_world * p) : p[n.axis];
  const auto found = done.find(t.identity());
  if (found != done.end()) return found->second;
  std::array<double, 8> values{};
  for (std::size_t i = 0; i < n.operands.size(); ++i) values[i] = walk(n.operands[i], p, done);
  const double value = apply_one(n.op, {values.data(), n.operands.size()});
  done.emplace(t.identity(), value);
  return value;
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
  if (constant_operands) return constant(apply_one(op, {values.data(), operands.size()}));
  return Term(std::make_shared<TermNode>(TermNode{.op = op, .operands = std::move(operands)}));
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
  std::array<Term, 3> rows;
  for (std::size_t row = 0; row < 3; ++row) {
    Term sum = constant(source_from_target.translation[row]);
    for (std::size_t column = 3; column-- > 0;) {
      const double factor = source_from_target.linear(row, column);
      if (factor == 0) continue;
      const Term product = factor == 1 ? coordinate(column) : factor * coordinate(column);
      sum = sum.is_constant() && sum.node().number == 0 ? product : product + sum;
    }
    rows[row] = sum;
  }
  return Rebuild([&](const Term& leaf) {
    const TermNode& n = leaf.node();
    if (n.op == Op::number) return leaf;
    if (n.axis == TermNode::external_axis) return external(n.external, n.field_from_world * source_from_target);
    return rows[n.axis];
  })(*this);
}

double Term::value(Vec3 p) const {
  std::unordered_map<const TermNode*, double> done;
  return walk(*this, p, done);
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
