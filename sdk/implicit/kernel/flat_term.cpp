// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/flat_term.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <memory>
#include <unordered_map>

#include "meso/expr/operations.hpp"
#include "meso/implicit/interval_arithmetic.hpp"
#include "scalar_operation.hpp"

namespace meso::implicit {

using expr::Op;

namespace {

/// The box's image under an affine map, as a box.
Box3 image(const Affine& map, const Box3& box) {
  Box3 result;
  for (std::size_t row = 0; row < 3; ++row) {
    Interval sum{map.translation[row], map.translation[row]};
    for (std::size_t column = 0; column < 3; ++column) {
      const double factor = map.linear(row, column);
      if (factor == 0) continue;
      const Interval product[] = {{factor, factor}, {box.min[column], box.max[column]}};
      const Interval next[] = {sum, interval_of(Op::multiply, product)};
      sum = interval_of(Op::add, next);
    }
    result.min[row] = sum.lo;
    result.max[row] = sum.hi;
  }
  return result;
}

template <Op op>
bool apply_all(const double* a, const double* b, std::size_t count, double* out) {
  for (std::size_t i = 0; i < count; ++i) {
    if constexpr (op == Op::negate || op == Op::abs || op == Op::sqrt)
      out[i] = expr::apply<op>(a[i]);
    else
      out[i] = expr::apply<op>(a[i], b[i]);
  }
  return true;
}

template <Op... ops>
bool apply_one_of(Op op, const double* a, const double* b, std::size_t count, double* out) {
  return ((op == ops && apply_all<ops>(a, b, count, out)) || ...);
}

/// The operations that bodies are mostly made of, chosen once for all points; whether it is one of them.
bool apply_often(Op op, const double* a, const double* b, std::size_t count, double* out) {
  return apply_one_of<Op::negate, Op::abs, Op::sqrt, Op::add, Op::subtract, Op::multiply, Op::divide, Op::min, Op::max>(
      op, a, b, count, out);
}

}  // namespace

FlatTerm::FlatTerm(const Term& term) : term_(term) {
  struct Visit {
    const TermNode* node;
    std::size_t next_operand;
  };
  std::unordered_map<const TermNode*, std::uint32_t> index_of;
  std::unordered_multimap<std::uint64_t, std::uint32_t> steps_of_hash;
  std::vector<Visit> path{{term.identity(), 0}};
  while (!path.empty()) {
    Visit& visit = path.back();
    const TermNode& node = *visit.node;
    if (visit.next_operand < node.operands.size()) {
      const TermNode* operand = node.operands[visit.next_operand++].identity();
      if (!index_of.contains(operand)) path.push_back({operand, 0});
      continue;
    }
    path.pop_back();
    if (index_of.contains(&node)) continue;
    const std::uint32_t candidate = static_cast<std::uint32_t>(steps_.size());
    steps_.push_back({.op = node.op,
                      .operands = static_cast<std::uint8_t>(node.operands.size()),
                      .first_operand = static_cast<std::uint32_t>(operands_.size()),
                      .node = &node});
    for (const Term& operand : node.operands) operands_.push_back(index_of.at(operand.identity()));
    // The same operation of the same steps is the same step, whichever node says so.
    const std::uint64_t hash = hash_of(steps_.back());
    const auto [first, last] = steps_of_hash.equal_range(hash);
    const auto twin =
        std::find_if(first, last, [&](const auto& entry) { return equal(steps_[entry.second], steps_.back()); });
    if (twin == last) {
      steps_of_hash.emplace(hash, candidate);
      index_of.emplace(&node, candidate);
    } else {
      index_of.emplace(&node, twin->second);
      operands_.resize(steps_.back().first_operand);
      steps_.pop_back();
    }
  }
}

std::uint64_t FlatTerm::hash_of(const Step& step) const {
  std::uint64_t h = static_cast<std::uint64_t>(step.op);
  const auto mix = [&h](std::uint64_t v) {
    h = (h ^ v) * 0x9E3779B97F4A7C15U;
    h ^= h >> 32;
  };
  mix(std::bit_cast<std::uint64_t>(step.node->number));
  mix(step.node->axis);
  for (const std::uint32_t index : operands(step)) mix(index);
  return h;
}

bool FlatTerm::equal(const Step& a, const Step& b) const {
  return a.op == b.op && a.node->axis == b.node->axis && a.node->external == b.node->external &&
         std::bit_cast<std::uint64_t>(a.node->number) == std::bit_cast<std::uint64_t>(b.node->number) &&
         std::ranges::equal(operands(a), operands(b)) &&
         (!a.node->external || a.node->field_from_world == b.node->field_from_world);
}

double FlatTerm::value(Vec3 p) const {
  double result = 0;
  values({&p, 1}, {&result, 1});
  return result;
}

void FlatTerm::values(std::span<const Vec3> points, std::span<double> out) const {
  assert(points.size() == out.size());
  // So many points at once that their intermediate values stay in the cache.
  const std::size_t batch = std::clamp<std::size_t>(16384 / steps_.size(), 1, std::max<std::size_t>(points.size(), 1));
  const auto table = std::make_unique_for_overwrite<double[]>(steps_.size() * batch);
  for (std::size_t first = 0; first < points.size(); first += batch) {
    const std::size_t count = std::min(batch, points.size() - first);
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      const Step& step = steps_[s];
      const TermNode& node = *step.node;
      double* row = &table[s * batch];
      if (step.op == Op::number) {
        if (first == 0) std::fill_n(row, count, node.number);  // later batches are no longer
      } else if (step.op == Op::name) {
        for (std::size_t i = 0; i < count; ++i)
          row[i] = node.axis == TermNode::external_axis
                       ? node.external->value(node.field_from_world * points[first + i])
                       : points[first + i][node.axis];
      } else {
        const std::span<const std::uint32_t> indices = operands(step);
        const auto operand = [&](std::size_t k) { return &table[indices[k] * batch]; };
        if (apply_often(step.op, operand(0), operand(indices.size() - 1), count, row)) continue;
        std::array<double, 8> v{};
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t k = 0; k < indices.size(); ++k) v[k] = operand(k)[i];
          row[i] = apply_operation(step.op, {v.data(), indices.size()});
        }
      }
    }
    std::copy_n(&table[(steps_.size() - 1) * batch], count, out.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

std::vector<Interval> FlatTerm::intervals(const Box3& box) const {
  std::vector<Interval> value(steps_.size());
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const Step& step = steps_[s];
    const TermNode& node = *step.node;
    if (step.op == Op::number) {
      value[s] = std::isnan(node.number) ? Interval{0, 0, true} : Interval{node.number, node.number};
    } else if (step.op == Op::name) {
      value[s] = node.axis == TermNode::external_axis ? node.external->interval(image(node.field_from_world, box))
                                                      : Interval{box.min[node.axis], box.max[node.axis]};
    } else {
      const std::span<const std::uint32_t> indices = operands(step);
      std::array<Interval, 8> v;
      for (std::size_t k = 0; k < indices.size(); ++k) v[k] = value[indices[k]];
      const bool same = step.op == Op::multiply && indices[0] == indices[1];
      value[s] = same ? square(v[0]) : interval_of(step.op, {v.data(), indices.size()});
    }
  }
  return value;
}

Interval FlatTerm::interval(const Box3& box) const { return intervals(box).back(); }

}  // namespace meso::implicit
