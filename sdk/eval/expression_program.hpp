// SPDX-License-Identifier: Apache-2.0
#pragma once
// An expression compiled for repeated evaluation by muParser, with our grammar, our operations and our errors.
//
//   ExpressionProgram program(expression.bind(slots));
//   expr::EvalResult result = program.evaluate(values);   // the bits that expr::evaluate() gives
//
// muParser gets no text of the document: the tree is written out again as calls of our own checked operations, so that
// none of its functions, operators, constants or rules of precedence can take part. Thread rule: one program per
// thread (evaluation writes into it); copies are independent.

#include <memory>
#include <span>

#include "meso/expr/expression.hpp"

namespace meso::eval {

class ExpressionProgram {
 public:
  explicit ExpressionProgram(const expr::Expression& expression);
  ExpressionProgram(const ExpressionProgram& other);
  ExpressionProgram(ExpressionProgram&&) noexcept;
  ExpressionProgram& operator=(ExpressionProgram other) noexcept;
  ~ExpressionProgram();

  /// REQUIRES: a finite value in every slot that the expression reads. No allocation.
  [[nodiscard]] expr::EvalResult evaluate(std::span<const double> slots);

  /// False for the very long expressions that muParser does not take (20 000 characters as written out); those are
  /// walked, with the same results.
  [[nodiscard]] bool is_compiled() const;

 private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace meso::eval
