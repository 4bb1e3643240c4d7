// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cassert>
#include <cmath>

#include "meso/expr/expression.hpp"
#include "meso/expr/operations.hpp"

namespace meso::expr {
namespace {

// Per level of nesting at most seven arguments of hash, and the left sides of ^, *, + and < wait for their right one.
constexpr std::size_t stack_size = (max_nesting + 1) * 11;

/// Carries out one operation on the values below `top`; returns the new top.
double* step(const Node& node, double* top) {
  const auto unary = [&](auto f) {
    top[-1] = f(top[-1]);
    return top;
  };
  const auto binary = [&](auto f) {
    top[-2] = f(top[-2], top[-1]);
    return top - 1;
  };
#define MESO_UNARY(op) \
  case Op::op:         \
    return unary([](double x) { return apply<Op::op>(x); })
#define MESO_BINARY(op) \
  case Op::op:          \
    return binary([](double x, double y) { return apply<Op::op>(x, y); })
  switch (node.op) {
    MESO_UNARY(negate);
    MESO_UNARY(logical_not);
    MESO_UNARY(floor);
    MESO_UNARY(ceil);
    MESO_UNARY(round);
    MESO_UNARY(abs);
    MESO_UNARY(sign);
    MESO_UNARY(sqrt);
    MESO_UNARY(exp);
    MESO_UNARY(log);
    MESO_UNARY(sin);
    MESO_UNARY(cos);
    MESO_UNARY(tan);
    MESO_UNARY(asin);
    MESO_UNARY(acos);
    MESO_UNARY(atan);
    MESO_BINARY(add);
    MESO_BINARY(subtract);
    MESO_BINARY(multiply);
    MESO_BINARY(divide);
    MESO_BINARY(power);
    MESO_BINARY(less);
    MESO_BINARY(less_equal);
    MESO_BINARY(greater);
    MESO_BINARY(greater_equal);
    MESO_BINARY(equal);
    MESO_BINARY(not_equal);
    MESO_BINARY(mod);
    MESO_BINARY(atan2);
    MESO_BINARY(hypot);
    MESO_BINARY(min);
    MESO_BINARY(max);
    case Op::clamp:
      top[-3] = apply<Op::clamp>(top[-3], top[-2], top[-1]);
      return top - 2;
    case Op::hash: {
      double* const first = top - node.operands;
      *first = apply_hash({first, node.operands});
      return first + 1;
    }
    case Op::logical_and:
    case Op::logical_or:
      top[-1] = top[-1] != 0 ? 1 : 0;
      return top;
    default:
      return top;  // select: its value is there; leaves and skips are the walk's business
  }
#undef MESO_UNARY
#undef MESO_BINARY
}

}  // namespace

EvalResult evaluate(const Expression& expression, std::span<const double> slots) {
  std::array<double, stack_size> stack;  // not initialised: every value is written before it is read
  double* top = stack.data();
  const std::vector<Node>& nodes = expression.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    switch (node.op) {
      case Op::number:
        *top++ = node.number;
        break;
      case Op::name:
        assert(node.index < slots.size() && std::isfinite(slots[node.index]));
        *top++ = slots[node.index];
        break;
      case Op::skip_if_zero:
        if (*--top == 0) i = node.index - 1;
        break;
      case Op::skip:
        i = node.index - 1;
        break;
      case Op::and_skip:
        if (*--top == 0) {
          *top++ = 0;  // the value may have been a negative zero
          i = node.index - 1;
        }
        break;
      case Op::or_skip:
        if (*--top != 0) {
          *top++ = 1;
          i = node.index - 1;
        }
        break;
      default:
        top = step(node, top);
        if (!std::isfinite(top[-1])) return {.value = 0, .failed_offset = node.offset, .failed_length = node.length};
    }
  }
  return {.value = stack[0]};
}

}  // namespace meso::expr
