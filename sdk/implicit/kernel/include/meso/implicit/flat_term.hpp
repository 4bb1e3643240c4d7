// SPDX-License-Identifier: Apache-2.0
#pragma once
// A term written as a list of steps, operands before operations, equal ones once: what one walks without recursion and
// evaluates with any kind of number - doubles, intervals, and both with their derivatives.
//
//   const FlatTerm flat(term);
//   flat.value({1, 0, 0});
//   flat.interval({{-1, -1, -1}, {1, 1, 1}});     // holds every value in that box
//   flat.gradient({1, 0, 0});                     // exact derivatives, not differences
//   flat.lipschitz(box);                          // |f(p) - f(q)| <= it |p - q| in the box, or infinity
//
// Time and memory linear in the number of distinct nodes, at any depth. Const members may be called by many threads.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meso/implicit/interval.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

class FlatTerm {
 public:
  struct Step {
    expr::Op op{};
    std::uint8_t operands = 0;
    std::uint32_t first_operand = 0;  ///< in the list of operands
    const TermNode* node = nullptr;   ///< numbers, axes and external leaves are read here
  };

  explicit FlatTerm(const Term& term);

  /// Distinct; the last one is the term itself.
  [[nodiscard]] std::span<const Step> steps() const { return steps_; }
  /// Indices of earlier steps.
  [[nodiscard]] std::span<const std::uint32_t> operands(const Step& step) const {
    return {operands_.data() + step.first_operand, step.operands};
  }

  [[nodiscard]] double value(Vec3 p) const;
  /// REQUIRES: as many values as points. Several times faster per point than value().
  void values(std::span<const Vec3> points, std::span<double> out) const;
  [[nodiscard]] Interval interval(const Box3& box) const;
  /// Of every step.
  [[nodiscard]] std::vector<Interval> intervals(const Box3& box) const;
  /// One-sided where the term has a kink; NaN where it has no value. External leaves are differenced (step 1e-6).
  [[nodiscard]] Vec3 gradient(Vec3 p) const;
  /// The range of each partial derivative; infinite where the term may jump.
  [[nodiscard]] std::array<Interval, 3> gradient_interval(const Box3& box) const;
  [[nodiscard]] double lipschitz(const Box3& box) const;

 private:
  [[nodiscard]] std::uint64_t hash_of(const Step& step) const;
  [[nodiscard]] bool equal(const Step& a, const Step& b) const;

  Term term_;  // keeps the nodes alive
  std::vector<Step> steps_;
  std::vector<std::uint32_t> operands_;
};

/// For a single question; who asks more than once keeps a FlatTerm.
[[nodiscard]] inline Interval interval_of(const Term& term, const Box3& box) { return FlatTerm(term).interval(box); }

}  // namespace meso::implicit
