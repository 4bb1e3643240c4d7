// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/evaluation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "body.hpp"
#include "cell_stream_impl.hpp"
#include "evaluation_impl.hpp"
#include "field_source.hpp"
#include "meso/base/number.hpp"

namespace meso::eval {
namespace {

template <class T>
const T* find_by_id(const Section<T>& section, std::string_view id) {
  const auto found = std::find_if(section.begin(), section.end(), [&](const T& item) { return item.id.text == id; });
  return found == section.end() ? nullptr : &*found;
}

}  // namespace

std::optional<double> evaluate(const BoundExpression& expression, std::span<const double> slots, const Report& report) {
  const expr::EvalResult result = expression.evaluate(slots);
  if (result) return result.value;
  report.at(Code::expression_domain, expression.place, result.failed_offset, result.failed_length,
            {expression.expression.text().substr(result.failed_offset, result.failed_length)});
  return std::nullopt;
}

bool check_determinant(const Mat3& linear, bool mirror, const Place& place, const Report& report) {
  const double d = determinant(linear);
  if (std::isfinite(d) && (mirror ? d != 0 : d > 0)) return true;
  report(Code::transform_determinant, place, {format_number(d)});
  return false;
}

std::optional<double> EvaluationData::value(const Expression& expression, const Place& place,
                                            const Report& report) const {
  const auto bound = scope.bind(expression.text, place, unit(), report);
  return bound ? evaluate(*bound, parameters, report) : std::nullopt;
}

std::optional<std::vector<double>> EvaluationData::values(const ExpressionList& list, const Place& place,
                                                          std::size_t count, const Report& report) const {
  const auto bound = scope.bind_list(list.text, place, count, unit(), report);
  if (!bound) return std::nullopt;
  std::vector<double> result;
  for (const BoundExpression& one : *bound) {
    const auto number = evaluate(one, parameters, report);
    if (!number) return std::nullopt;
    result.push_back(*number);
  }
  return result;
}

std::optional<Vec3> EvaluationData::vector(const Element& element, const std::optional<Expression>& x,
                                           const std::optional<Expression>& y, const std::optional<Expression>& z,
                                           double otherwise, const Report& report) const {
  static constexpr std::string_view names[] = {"x", "y", "z"};
  const std::optional<Expression>* components[] = {&x, &y, &z};
  Vec3 result{otherwise, otherwise, otherwise};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!*components[i]) continue;
    const auto number = value(**components[i], {element.id_in_source, names[i]}, report);
    if (!number) return std::nullopt;
    result[i] = *number;
  }
  return result;
}

std::optional<Affine> EvaluationData::affine(const Placement& placement, const Report& report) const {
  const Place place{placement.id_in_source, "matrix"};
  const auto rows = values(placement.matrix, place, 12, report);
  if (!rows) return std::nullopt;
  std::array<double, 12> matrix{};
  std::copy(rows->begin(), rows->end(), matrix.begin());
  const Affine result = Affine::from_rows(matrix);
  if (!check_determinant(result.linear, placement.mirror.value_or(false), place, report)) return std::nullopt;
  return result;
}

std::optional<Evaluation> Evaluation::make(const CheckedDocument& document, const EvaluateOptions& options,
                                           DiagnosticSink& sink) {
  auto data = std::make_shared<Impl>(Impl{{.checked = document, .run = options.run}});
  data->distance = options.distance;
  data->fields = std::make_shared<FieldCache>();
  if (!evaluate_parameters(*data, options.overrides, sink) || !evaluate_frames(*data, sink)) return std::nullopt;
  return Evaluation(std::move(data));
}

const CheckedDocument& Evaluation::checked() const { return impl_->checked; }
const Document& Evaluation::document() const { return impl_->document(); }

std::optional<double> Evaluation::parameter(std::string_view id) const {
  const auto& all = document().parameters.items;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.id.text == id; });
  if (found == all.end()) return std::nullopt;
  return impl_->parameters[static_cast<std::size_t>(found - all.begin())];
}

std::optional<double> Evaluation::value(const Expression& expression, ElementId where, std::string_view attribute,
                                        DiagnosticSink& sink) const {
  return impl_->value(expression, {where, attribute}, impl_->report(sink));
}

const Pattern* Evaluation::find_pattern(std::string_view id) const { return find_by_id(document().patterns, id); }
const Part* Evaluation::find_part(std::string_view id) const { return find_by_id(document().parts, id); }

PointQuantity Evaluation::quantity(std::string_view name, ElementId where, DiagnosticSink& sink) const {
  const std::string_view id = name.substr(0, name.find('.'));
  const VectorField* field = find_by_id(document().vector_fields, id);
  assert(field != nullptr);  // validation knows the names
  const auto all = field_quantities(*field);
  const auto wanted = std::find_if(all.begin(), all.end(),
                                   [&](const FieldQuantity& q) { return q.name == name.substr(id.size() + 1); });
  assert(wanted != all.end());
  const auto source = impl_->fields->find(*impl_, *field, true, impl_->report(sink));
  if (!source) return {};
  return [impl = impl_, source, slot = QuantitySlot{*wanted, 0}, where](Vec3 p_mm,
                                                                        DiagnosticSink& told) -> std::optional<double> {
    double value = 0;
    const bool known =
        source->at_point(p_mm / impl->millimeters(), {&slot, 1}, {&value, 1}, {where, "value"}, impl->report(told));
    return known ? std::optional(value) : std::nullopt;
  };
}

std::optional<CellStream> Evaluation::cells(const Pattern& pattern, DiagnosticSink& sink) const {
  auto impl = make_cell_stream(impl_, pattern, sink);
  if (!impl) return std::nullopt;
  return CellStream(std::move(impl));
}

std::optional<Shape> Evaluation::shape(const Macrostructure& macrostructure, DiagnosticSink& sink) const {
  const Report report = impl_->report(sink);
  const auto table = BodyTable::make(*impl_, macrostructure, impl_->scope, report);
  if (!table) return std::nullopt;
  auto body = make_shape(*impl_, *table, macrostructure, impl_->parameters, report);
  if (!body || !macrostructure.placement) return body;
  const auto map = placement(macrostructure.placement, sink);
  if (!map) return std::nullopt;
  return Shape{TransformedShape{*map, {std::move(*body)}}, macrostructure.placement->id_in_source};
}

std::optional<Affine> Evaluation::placement(const std::optional<Placement>& placement, DiagnosticSink& sink) const {
  if (!placement) return Affine{};
  auto result = impl_->affine(*placement, impl_->report(sink));
  if (result) result->translation = impl_->millimeters() * result->translation;
  return result;
}

}  // namespace meso::eval
