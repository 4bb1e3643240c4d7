// SPDX-License-Identifier: Apache-2.0
#include "meso/expr/dimension.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "literal.hpp"

namespace meso::expr {
namespace {

/// A value on the stack, and the number or name that its dimension comes from.
struct Operand {
  Dimension dimension = Dimension::open;
  std::string_view witness{};

  [[nodiscard]] bool is_bound() const { return dimension >= Dimension::length; }
};

Dimension dimension_of_literal(std::string_view literal) {
  const std::size_t last_digit = literal.find_last_of("0123456789.");
  if (last_digit == std::string_view::npos) return Dimension::open;  // pi: a ratio, or half a turn
  const std::optional<Suffix> suffix = find_suffix(literal.substr(last_digit + 1));
  if (!suffix || *suffix == Suffix::none) return Dimension::open;
  return *suffix == Suffix::deg || *suffix == Suffix::rad ? Dimension::angle : Dimension::length;
}

Operand product(const Operand& a, const Operand& b) {
  if (a.dimension == Dimension::number) return b;
  if (b.dimension == Dimension::number) return a;
  return {};
}

Operand quotient(const Operand& a, const Operand& b) {
  if (b.dimension == Dimension::number) return a;
  if (a.is_bound() && a.dimension == b.dimension) return {.dimension = Dimension::number};
  return {};
}

/// Of values that are added, compared or chosen from: a unit binds the others.
Operand joined(const Operand& a, const Operand& b) {
  if (a.is_bound()) return a;
  if (b.is_bound()) return b;
  return a.dimension == b.dimension ? a : Operand{};
}

Operand if_number(const Operand& a) { return a.dimension == Dimension::number ? a : Operand{}; }

class Walk {
 public:
  Walk(const Expression& expression, std::span<const Dimension> names) : text_(expression.text()) {
    for (std::size_t k = 0; k < std::min(names.size(), expression.names().size()); ++k)
      names_[expression.names()[k].text] = names[k];
  }

  DimensionResult run(const std::vector<Node>& nodes) {
    for (const Node& node : nodes) {
      if (node.op >= Op::skip_if_zero) continue;
      const std::span<const Operand> operands(stack_.data() + stack_.size() - node.operands, node.operands);
      const Operand value = step(node, operands);
      if (clash_) return {.clash = clash_};
      stack_.resize(stack_.size() - node.operands);
      stack_.push_back(value);
    }
    return {.dimension = stack_.back().dimension};
  }

 private:
  Operand step(const Node& node, std::span<const Operand> operands);
  Operand join(const Node& node, std::span<const Operand> operands);
  Operand leaf(const Node& node) const {
    const std::string_view text = text_.substr(node.offset, node.length);
    if (node.op == Op::number) return {dimension_of_literal(text), text};
    const auto name = names_.find(text);
    return {name == names_.end() ? Dimension::open : name->second, text};
  }

  std::string_view text_;
  std::unordered_map<std::string_view, Dimension> names_;
  std::vector<Operand> stack_;
  std::optional<DimensionClash> clash_;
};

Operand Walk::join(const Node& node, std::span<const Operand> operands) {
  Operand all = operands.front();
  for (const Operand& other : operands.subspan(1)) {
    if (!fits(all.dimension, other.dimension) && !clash_)
      clash_ = DimensionClash{.first = all.witness,
                              .second = other.witness,
                              .first_is = all.dimension,
                              .offset = node.offset,
                              .length = node.length};
    all = joined(all, other);
  }
  return all;
}

Operand Walk::step(const Node& node, std::span<const Operand> operands) {
  constexpr Operand number{.dimension = Dimension::number};
  switch (node.op) {
    case Op::number:
    case Op::name:
      return leaf(node);
    case Op::negate:
    case Op::abs:
      return operands[0];
    case Op::add:
    case Op::subtract:
    case Op::mod:
    case Op::min:
    case Op::max:
    case Op::clamp:
    case Op::hypot:
      return join(node, operands);
    case Op::select:
      return join(node, operands.subspan(1));
    case Op::less:
    case Op::less_equal:
    case Op::greater:
    case Op::greater_equal:
    case Op::equal:
    case Op::not_equal:
      (void)join(node, operands);
      return number;
    case Op::atan2:  // a ratio of its arguments; the angle is in radians, and no unit says so
      (void)join(node, operands);
      return {};
    case Op::multiply:
      return product(operands[0], operands[1]);
    case Op::divide:
      return quotient(operands[0], operands[1]);
    case Op::power:
      return operands[1].dimension == Dimension::number ? if_number(operands[0]) : Operand{};
    case Op::floor:
    case Op::ceil:
    case Op::round:
    case Op::sqrt:
      return if_number(operands[0]);
    case Op::logical_not:
    case Op::logical_and:
    case Op::logical_or:
    case Op::sign:
    case Op::sin:
    case Op::cos:
    case Op::tan:
    case Op::exp:
    case Op::log:
    case Op::hash:
      return number;
    default:  // asin, acos, atan: as atan2
      return {};
  }
}

}  // namespace

DimensionResult dimension_of(const Expression& expression, std::span<const Dimension> names) {
  return Walk(expression, names).run(expression.nodes());
}

std::string_view to_text(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return "a length";
    case Dimension::angle:
      return "an angle";
    default:
      return "a number";
  }
}

}  // namespace meso::expr
