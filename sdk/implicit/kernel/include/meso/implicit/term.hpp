// SPDX-License-Identifier: Apache-2.0
#pragma once
// A function of the point (x, y, z), as a tree of operations: what every field is lowered to before it is compiled, so
// that a user's text, a built-in surface and a tree of operations go through one planner.
//
//   Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);
//   Term ball = sqrt(x * x + y * y + z * z) - 1;
//   Term moved = ball.at(Affine::from_translation({-2, 0, 0}));   // its centre is (2, 0, 0)
//   moved.value({2, 0, 0}) == -1
//
// Terms are values: copies share their nodes, nothing ever changes, threads may share them freely. Operations mean what
// docs/specification/expressions.md says, except that a result that is not finite is a value like any other: where a
// field ends up as NaN the point is outside.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "meso/base/vec.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/external_field.hpp"

namespace meso::implicit {

class Term;

/// One operation. Leaves: Op::number; Op::name, whose `axis` is 0, 1, 2 for x, y, z or `external_axis`.
struct TermNode {
  static constexpr std::uint32_t external_axis = 3;

  expr::Op op{};
  std::uint32_t axis = 0;
  double number = 0;
  std::vector<Term> operands;  // no initializer: clang would need the class whole here
  std::shared_ptr<const ExternalField> external{};
  Affine field_from_world{};  ///< of an external leaf

  ~TermNode();
};

class Term {
 public:
  Term() : Term(constant(0)) {}
  [[nodiscard]] static Term constant(double value);
  [[nodiscard]] static Term coordinate(std::size_t axis);
  [[nodiscard]] static Term external(std::shared_ptr<const ExternalField> field, const Affine& field_from_world = {});
  /// Constant operands are folded. REQUIRES: as many operands as `op` takes (expr::Node says how many).
  [[nodiscard]] static Term apply(expr::Op op, std::vector<Term> operands);
  /// The tree of an expression, names replaced: names()[k] becomes term_of_name[k].
  [[nodiscard]] static Term from_expression(const expr::Expression& expression, std::span<const Term> term_of_name);

  /// p -> this(source_from_target p). Shared nodes stay shared; affine maps fold into external leaves.
  [[nodiscard]] Term at(const Affine& source_from_target) const;
  /// p -> this(x(p), y(p), z(p)). REQUIRES: no external leaves.
  [[nodiscard]] Term with(const std::array<Term, 3>& xyz) const;
  [[nodiscard]] bool has_external() const;

  /// The plain walk at one point: slow, the yardstick of every kernel.
  [[nodiscard]] double value(Vec3 p) const;

  [[nodiscard]] const TermNode& node() const { return *node_; }
  [[nodiscard]] bool is_constant() const { return node_->op == expr::Op::number; }
  /// Same node, not merely equal ones.
  [[nodiscard]] const TermNode* identity() const { return node_.get(); }
  [[nodiscard]] bool is_last_owner() const { return node_.use_count() == 1; }

 private:
  explicit Term(std::shared_ptr<const TermNode> node) : node_(std::move(node)) {}
  std::shared_ptr<const TermNode> node_;
};

[[nodiscard]] Term operator+(const Term& a, const Term& b);
[[nodiscard]] Term operator-(const Term& a, const Term& b);
[[nodiscard]] Term operator*(const Term& a, const Term& b);
[[nodiscard]] Term operator/(const Term& a, const Term& b);
[[nodiscard]] Term operator-(const Term& a);
[[nodiscard]] inline Term operator+(const Term& a, double b) { return a + Term::constant(b); }
[[nodiscard]] inline Term operator-(const Term& a, double b) { return a - Term::constant(b); }
[[nodiscard]] inline Term operator*(double a, const Term& b) { return Term::constant(a) * b; }
[[nodiscard]] Term min(const Term& a, const Term& b);
[[nodiscard]] Term max(const Term& a, const Term& b);
[[nodiscard]] Term abs(const Term& a);
[[nodiscard]] Term sqrt(const Term& a);

}  // namespace meso::implicit
