// SPDX-License-Identifier: Apache-2.0
// Derivatives of a flat term, carried forward with the values: one set of rules for numbers and for intervals.

#include <algorithm>
#include <array>
#include <cmath>

#include "meso/expr/operations.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/interval_arithmetic.hpp"
#include "scalar_operation.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

const Interval anything{-HUGE_VAL, HUGE_VAL, false};

double apply(Op op, double a) { return apply_operation(op, {&a, 1}); }
double apply(Op op, double a, double b) {
  const double v[] = {a, b};
  return apply_operation(op, v);
}
Interval apply(Op op, Interval a) { return interval_of(op, {&a, 1}); }
Interval apply(Op op, Interval a, Interval b) {
  const Interval v[] = {a, b};
  return interval_of(op, v);
}

double number(double v, double) { return v; }
Interval number(double v, const Interval&) { return {v, v}; }
bool is_zero(double v) { return v == 0; }
bool is_zero(Interval v) { return v.lo == 0 && v.hi == 0; }

/// The product of a partial derivative and an inner one: an inner derivative of 0 wins over a partial of infinity, so
/// that sqrt(max(x, 0)^2) is flat where max is.
template <class T>
T chained(T partial, T inner) {
  return is_zero(inner) || is_zero(partial) ? number(0, inner) : apply(Op::multiply, partial, inner);
}

bool is_step(Op op) {
  switch (op) {
    case Op::floor:
    case Op::ceil:
    case Op::round:
    case Op::sign:
    case Op::hash:
    case Op::logical_not:
    case Op::logical_and:
    case Op::logical_or:
    case Op::less:
    case Op::less_equal:
    case Op::greater:
    case Op::greater_equal:
    case Op::equal:
    case Op::not_equal:
      return true;
    default:
      return false;
  }
}

/// Whether the operation may jump within its operands' ranges: no slope covers that.
bool may_jump(Op op, Interval result, std::span<const Interval> v) {
  switch (op) {
    case Op::mod: {
      const Interval whole = apply(Op::floor, apply(Op::divide, v[0], v[1]));
      return whole.lo != whole.hi;
    }
    case Op::atan2:  // across the negative axis, and in the origin
      return (v[0].lo < 0 && v[0].hi >= 0 && v[1].lo < 0) || (v[0].contains(0) && v[1].contains(0));
    case Op::select:
      return choice_of(op, v) == Choice::none;
    default:
      return is_step(op) && result.lo != result.hi;
  }
}

/// Derivatives of an operation by its operands.
template <class T>
std::array<T, 3> partials(Op op, std::span<const T> v, T result) {
  const T zero = number(0, result), one = number(1, result);
  const auto quotient = [](T a, T b) { return apply(Op::divide, a, b); };
  const auto product = [](T a, T b) { return apply(Op::multiply, a, b); };
  const auto square_of = [](T a) { return apply(Op::power, a, number(2, a)); };
  switch (op) {
    case Op::negate:
      return {number(-1, result), zero, zero};
    case Op::add:
      return {one, one, zero};
    case Op::subtract:
      return {one, number(-1, result), zero};
    case Op::multiply:
      return {v[1], v[0], zero};
    case Op::divide:
      return {quotient(one, v[1]), apply(Op::negate, quotient(result, v[1])), zero};
    case Op::power:
      return {product(v[1], apply(Op::power, v[0], apply(Op::subtract, v[1], one))),
              product(result, apply(Op::log, v[0])), zero};
    case Op::abs:
      return {apply(Op::sign, v[0]), zero, zero};
    case Op::sqrt:
      return {quotient(number(0.5, result), result), zero, zero};
    case Op::exp:
      return {result, zero, zero};
    case Op::log:
      return {quotient(one, v[0]), zero, zero};
    case Op::sin:
      return {apply(Op::cos, v[0]), zero, zero};
    case Op::cos:
      return {apply(Op::negate, apply(Op::sin, v[0])), zero, zero};
    case Op::tan:
      return {apply(Op::add, one, square_of(result)), zero, zero};
    case Op::asin:
    case Op::acos: {
      const T slope = quotient(one, apply(Op::sqrt, apply(Op::subtract, one, square_of(v[0]))));
      return {op == Op::asin ? slope : apply(Op::negate, slope), zero, zero};
    }
    case Op::atan:
      return {quotient(one, apply(Op::add, one, square_of(v[0]))), zero, zero};
    case Op::atan2: {
      const T r2 = apply(Op::add, square_of(v[0]), square_of(v[1]));
      return {quotient(v[1], r2), apply(Op::negate, quotient(v[0], r2)), zero};
    }
    case Op::hypot: {  // both in [-1, 1]
      const T least = number(-1, result);
      const auto limited = [&](T a) { return apply(Op::min, apply(Op::max, a, least), one); };
      return {limited(quotient(v[0], result)), limited(quotient(v[1], result)), zero};
    }
    case Op::mod:
      return {one, apply(Op::negate, apply(Op::floor, quotient(v[0], v[1]))), zero};
    default:  // steps
      return {zero, zero, zero};
  }
}

template <class T>
using Gradient = std::array<T, 3>;

/// The gradient of min, max, clamp and select: that of the operand that is taken.
Gradient<double> taken(Op op, std::span<const double> v, std::span<const Gradient<double>> inner) {
  switch (op) {
    case Op::min:
      return v[1] < v[0] ? inner[1] : inner[0];
    case Op::max:
      return v[1] > v[0] ? inner[1] : inner[0];
    case Op::select:
      return v[0] != 0 ? inner[1] : inner[2];
    default: {  // clamp
      const std::size_t raised = v[1] > v[0] ? 1 : 0;
      return v[2] < v[raised] ? inner[2] : inner[raised];
    }
  }
}
Gradient<Interval> hull_of(const Gradient<Interval>& a, const Gradient<Interval>& b) {
  return {hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2])};
}
/// ... or of those that may be.
Gradient<Interval> taken(Op op, std::span<const Interval> v, std::span<const Gradient<Interval>> inner) {
  if (op == Op::clamp) {
    const std::array<Interval, 2> limits{apply(Op::max, v[0], v[1]), v[2]};
    const std::array<Gradient<Interval>, 2> gradients{taken(Op::max, v.first(2), inner.first(2)), inner[2]};
    return taken(Op::min, limits, gradients);
  }
  const std::size_t first = op == Op::select ? 1 : 0;
  switch (choice_of(op, v)) {
    case Choice::first:
      return inner[first];
    case Choice::second:
      return inner[first + 1];
    default:
      return hull_of(inner[first], inner[first + 1]);
  }
}

/// The gradient of a step from its operands' values and gradients.
template <class T>
Gradient<T> chain(Op op, std::span<const T> v, std::span<const Gradient<T>> inner, T result) {
  const T zero = number(0, result);
  Gradient<T> gradient{zero, zero, zero};
  const bool varies = std::any_of(inner.begin(), inner.end(), [](const Gradient<T>& g) {
    return !is_zero(g[0]) || !is_zero(g[1]) || !is_zero(g[2]);
  });
  if (!varies) return gradient;
  if constexpr (std::is_same_v<T, Interval>) {
    if (may_jump(op, result, v)) return {anything, anything, anything};
  }
  if (is_step(op)) return gradient;
  if (op == Op::min || op == Op::max || op == Op::clamp || op == Op::select) return taken(op, v, inner);
  const std::array<T, 3> partial = partials(op, v, result);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < std::min<std::size_t>(inner.size(), 3); ++k) {
      const T term = chained(partial[k], inner[k][axis]);
      if (!is_zero(term)) gradient[axis] = is_zero(gradient[axis]) ? term : apply(Op::add, gradient[axis], term);
    }
  return gradient;
}

double largest(Interval x) { return std::max(std::abs(x.lo), std::abs(x.hi)); }

/// |d sqrt(a^2 + b^2 + ...)| <= sqrt(da^2 + db^2 + ...) by Cauchy and Schwarz, where the plain rule divides by a range
/// that may hold 0. `step` is a square root; looks through its sums for squares.
std::optional<Gradient<double>> norm_slopes(const FlatTerm& flat, const FlatTerm::Step& root,
                                            std::span<const Gradient<Interval>> gradients) {
  Gradient<double> sum{0, 0, 0};
  std::vector<std::uint32_t> open{flat.operands(root)[0]};
  while (!open.empty()) {
    const FlatTerm::Step& step = flat.steps()[open.back()];
    open.pop_back();
    const std::span<const std::uint32_t> operands = flat.operands(step);
    if (step.op == Op::add) {
      open.insert(open.end(), operands.begin(), operands.end());
      if (open.size() > 64) return std::nullopt;  // a shared sum may unfold without end
      continue;
    }
    const bool squared = (step.op == Op::multiply && operands[0] == operands[1]) ||
                         (step.op == Op::power && flat.steps()[operands[1]].op == Op::number &&
                          flat.steps()[operands[1]].node->number == 2);
    if (!squared) return std::nullopt;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double slope = largest(gradients[operands[0]][axis]);
      sum[axis] += slope * slope * (1 + 1e-15);
    }
  }
  for (double& s : sum) s = std::sqrt(s) * (1 + 1e-15);
  return sum;
}

Gradient<double> leaf_gradient(const TermNode& node, Vec3 p) {
  if (node.axis != TermNode::external_axis) {
    Gradient<double> gradient{0, 0, 0};
    gradient[node.axis] = 1;
    return gradient;
  }
  const double h = 1e-6 * std::max(1.0, norm(p));
  Gradient<double> gradient{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 before = p, after = p;
    before[axis] -= h;
    after[axis] += h;
    gradient[axis] =
        (node.external->value(node.field_from_world * after) - node.external->value(node.field_from_world * before)) /
        (after[axis] - before[axis]);
  }
  return gradient;
}

Gradient<Interval> leaf_range(const TermNode& node) {
  Gradient<Interval> range{Interval{0, 0}, Interval{0, 0}, Interval{0, 0}};
  if (node.axis != TermNode::external_axis) {
    range[node.axis] = {1, 1};
    return range;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double slope = node.external->lipschitz() * norm(node.field_from_world.linear.column(axis)) * (1 + 1e-15);
    range[axis] = std::isnan(slope) ? anything : Interval{-slope, slope};
  }
  return range;
}

}  // namespace

Vec3 FlatTerm::gradient(Vec3 p) const {
  std::vector<double> value(steps_.size());
  std::vector<Gradient<double>> gradient(steps_.size());
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const Step& step = steps_[s];
    const TermNode& node = *step.node;
    if (step.op == Op::number) {
      value[s] = node.number;
    } else if (step.op == Op::name) {
      value[s] = node.axis == TermNode::external_axis ? node.external->value(node.field_from_world * p) : p[node.axis];
      gradient[s] = leaf_gradient(node, p);
    } else {
      std::array<double, 8> v{};
      std::array<Gradient<double>, 8> inner{};
      const std::span<const std::uint32_t> indices = operands(step);
      for (std::size_t k = 0; k < indices.size(); ++k) {
        v[k] = value[indices[k]];
        inner[k] = gradient[indices[k]];
      }
      value[s] = apply_operation(step.op, {v.data(), indices.size()});
      gradient[s] = chain<double>(step.op, {v.data(), indices.size()}, {inner.data(), indices.size()}, value[s]);
    }
  }
  if (std::isnan(value.back())) return {NAN, NAN, NAN};
  return {gradient.back()[0], gradient.back()[1], gradient.back()[2]};
}

std::array<Interval, 3> FlatTerm::gradient_interval(const Box3& box) const {
  const std::vector<Interval> value = intervals(box);
  std::vector<Gradient<Interval>> gradient(steps_.size(), {Interval{0, 0}, Interval{0, 0}, Interval{0, 0}});
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const Step& step = steps_[s];
    if (step.op == Op::number) continue;
    if (step.op == Op::name) {
      gradient[s] = leaf_range(*step.node);
      continue;
    }
    std::array<Interval, 8> v;
    std::array<Gradient<Interval>, 8> inner;
    const std::span<const std::uint32_t> indices = operands(step);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      v[k] = value[indices[k]];
      inner[k] = gradient[indices[k]];
    }
    gradient[s] = chain<Interval>(step.op, {v.data(), indices.size()}, {inner.data(), indices.size()}, value[s]);
    if (step.op != Op::sqrt) continue;
    if (const auto slopes = norm_slopes(*this, step, gradient))
      for (std::size_t axis = 0; axis < 3; ++axis)
        gradient[s][axis] = {std::max(gradient[s][axis].lo, -(*slopes)[axis]),
                             std::min(gradient[s][axis].hi, (*slopes)[axis])};
  }
  return gradient.back();
}

double FlatTerm::lipschitz(const Box3& box) const {
  const std::array<Interval, 3> range = gradient_interval(box);
  double sum = 0;
  for (const Interval& r : range) sum += largest(r) * largest(r);
  return std::isnan(sum) ? HUGE_VAL : std::sqrt(sum) * (1 + 1e-14);
}

}  // namespace meso::implicit
