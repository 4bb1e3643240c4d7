// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every part of evaluation shares: the document, the values of its parameters, its coordinate systems.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/base/unit.hpp"
#include "meso/eval/coordinates.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/model/checked_document.hpp"
#include "scope.hpp"

namespace meso::eval {

class FieldCache;

struct EvaluationData {
  CheckedDocument checked;
  RunOptions run;
  std::vector<double> parameters;  ///< in document order: slots 0, 1 ... of every scope
  Scope scope;                     ///< their names
  std::map<std::string, std::shared_ptr<const CoordinateFrame>, std::less<>> frames;  ///< document unit
  std::shared_ptr<const CoordinateFrame> cartesian;
  FindMacrostructureDistance distance;
  std::shared_ptr<FieldCache> fields;

  [[nodiscard]] const Document& document() const { return checked.document(); }
  [[nodiscard]] LengthUnit unit() const { return document().unit; }
  [[nodiscard]] double millimeters() const { return millimeters_per(unit()); }
  [[nodiscard]] Report report(DiagnosticSink& sink) const { return {checked.source(), sink}; }

  /// An expression of document parameters.
  [[nodiscard]] std::optional<double> value(const Expression& expression, const Place& place,
                                            const Report& report) const;
  [[nodiscard]] std::optional<std::vector<double>> values(const ExpressionList& list, const Place& place,
                                                          std::size_t count, const Report& report) const;
  /// Components that are absent are `otherwise`.
  [[nodiscard]] std::optional<Vec3> vector(const Element& element, const std::optional<Expression>& x,
                                           const std::optional<Expression>& y, const std::optional<Expression>& z,
                                           double otherwise, const Report& report) const;
  /// A 3x4 matrix in the document's unit whose determinant keeps the rule of `mirror`.
  [[nodiscard]] std::optional<Affine> affine(const Placement& placement, const Report& report) const;
};

/// The value, or a report of the subexpression that has none.
[[nodiscard]] std::optional<double> evaluate(const BoundExpression& expression, std::span<const double> slots,
                                             const Report& report);

/// determinant > 0 unless mirrored, and never 0. Reports and says false if not so.
[[nodiscard]] bool check_determinant(const Mat3& linear, bool mirror, const Place& place, const Report& report);

/// Fills in `data.parameters` and `data.scope`.
[[nodiscard]] bool evaluate_parameters(EvaluationData& data, const std::vector<Override>& overrides,
                                       DiagnosticSink& sink);
/// Fills in `data.frames`.
[[nodiscard]] bool evaluate_frames(EvaluationData& data, DiagnosticSink& sink);

struct Evaluation::Impl : EvaluationData {};

}  // namespace meso::eval
