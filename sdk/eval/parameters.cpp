// SPDX-License-Identifier: Apache-2.0
// Document parameters: in order, each an expression of earlier ones, overridden by the caller, within min and max.
#include <algorithm>
#include <map>

#include "evaluation_impl.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/dimension.hpp"

namespace meso::eval {
namespace {

/// What written units make of the parameters so far, and whether an override suits the value that it replaces
///
class ParameterDimensions {
 public:
  explicit ParameterDimensions(LengthUnit unit) : unit_(unit) {}

  /// Adds a parameter; false if reported.
  bool add(const Parameter& parameter, const Override* override_, DiagnosticSink& sink) {
    const expr::Dimension own = of(parameter.value.text).dimension;
    if (override_ == nullptr) {
      known_[parameter.id.text] = own;
      return true;
    }
    const auto [given, clash] = of(override_->expression);
    const bool suits = expr::fits(own, given);
    if (clash || !suits) {
      const std::string what = std::string(expr::to_text(own));
      Diagnostic fault{.code = Code::value_unit,
                       .args = {override_->expression, std::string(expr::to_text(given)),
                                "the parameter '" + parameter.id.text + "'", what}};
      if (clash) fault = {.code = Code::expression_units, .args = *clash};
      sink.report(
          {.code = Code::override_invalid, .args = {override_->id + "=" + override_->expression, message(fault)}});
    }
    known_[parameter.id.text] = given >= expr::Dimension::length ? given : own;
    return !clash && suits;
  }

 private:
  struct Found {
    expr::Dimension dimension = expr::Dimension::open;
    std::optional<std::vector<std::string>> clash{};  ///< arguments of EXPRESSION_UNITS
  };
  /// Open where the text has no tree: that is told when it is evaluated.
  [[nodiscard]] Found of(std::string_view text) const {
    const expr::ParseResult parsed = expr::parse_expression(text, unit_);
    if (!parsed.expression) return {};
    std::vector<expr::Dimension> names;
    for (const expr::Name& name : parsed.expression->names()) {
      const auto found = known_.find(name.text);
      names.push_back(found == known_.end() ? expr::Dimension::open : found->second);
    }
    const expr::DimensionResult result = expr::dimension_of(*parsed.expression, names);
    if (!result.clash) return {.dimension = result.dimension};
    const expr::DimensionClash& c = *result.clash;
    return {.clash = {{std::string(c.first), std::string(expr::to_text(c.first_is)), std::string(c.second),
                       std::string(expr::to_text(c.second_is()))}}};
  }

  LengthUnit unit_;
  std::map<std::string, expr::Dimension, std::less<>> known_;
};

/// Diagnostics of an override point into its text: `--set pitch=8mmm` has columns too.
std::optional<double> override_value(const EvaluationData& data, const Override& override_, DiagnosticSink& sink) {
  const SourceMap nowhere;
  DiagnosticSink faults;
  const Report report{nowhere, faults};
  std::optional<double> value;
  if (const auto bound = data.scope.bind(override_.expression, {}, data.unit(), report))
    value = evaluate(*bound, data.parameters, report);
  for (const Diagnostic& fault : faults.diagnostics())
    sink.report({.code = Code::override_invalid, .args = {override_.id + "=" + override_.expression, message(fault)}});
  return value;
}

bool check_bound(const EvaluationData& data, const Parameter& parameter, double value, bool upper,
                 const Report& report) {
  const std::optional<Expression>& bound = upper ? parameter.max : parameter.min;
  if (!bound) return true;
  const Place place{parameter.id_in_source, upper ? "max" : "min"};
  const std::optional<double> limit = data.value(*bound, place, report);
  if (!limit) return false;
  if (upper ? value <= *limit : value >= *limit) return true;
  report(Code::parameter_range, {parameter.id_in_source, "value"},
         {parameter.id.text, format_number(value), upper ? "greater than its max" : "less than its min",
          format_number(*limit)});
  return false;
}

bool check_overrides(const EvaluationData& data, const std::vector<Override>& overrides, DiagnosticSink& sink) {
  bool good = true;
  std::vector<std::string_view> ids;
  for (const Parameter& p : data.document().parameters) ids.push_back(p.id.text);
  for (auto o = overrides.begin(); o != overrides.end(); ++o) {
    const std::string text = o->id + "=" + o->expression;
    if (std::find(ids.begin(), ids.end(), o->id) == ids.end()) {
      sink.report({.code = Code::override_unknown_parameter, .args = {text, o->id, suggestion(o->id, ids)}});
      good = false;
    } else if (std::any_of(overrides.begin(), o, [&](const Override& before) { return before.id == o->id; })) {
      sink.report({.code = Code::override_invalid, .args = {text, "'" + o->id + "' is set twice"}});
      good = false;
    }
  }
  return good;
}

}  // namespace

bool evaluate_parameters(EvaluationData& data, const std::vector<Override>& overrides, DiagnosticSink& sink) {
  if (!check_overrides(data, overrides, sink)) return false;
  const Report report = data.report(sink);
  ParameterDimensions dimensions(data.unit());
  for (const Parameter& parameter : data.document().parameters) {
    const auto override_ =
        std::find_if(overrides.begin(), overrides.end(), [&](const Override& o) { return o.id == parameter.id.text; });
    if (!dimensions.add(parameter, override_ != overrides.end() ? &*override_ : nullptr, sink)) return false;
    const std::optional<double> value = override_ != overrides.end()
                                            ? override_value(data, *override_, sink)
                                            : data.value(parameter.value, {parameter.id_in_source, "value"}, report);
    // A parameter without a value would make every later one that uses it fail as well: the first fault is enough.
    if (!value) return false;
    if (!check_bound(data, parameter, *value, false, report) || !check_bound(data, parameter, *value, true, report))
      return false;
    data.scope.define(parameter.id.text, static_cast<std::uint32_t>(data.parameters.size()), constant_level);
    data.parameters.push_back(*value);
  }
  return true;
}

}  // namespace meso::eval
