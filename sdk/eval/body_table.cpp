// SPDX-License-Identifier: Apache-2.0
// A visitor of the format's one table collects every expression of a body.
#include "body.hpp"
#include "meso/model/describe.hpp"

namespace meso::eval {
namespace {

constexpr std::size_t matrix_entries = 12;

class ExpressionCollector {
 public:
  using Bound = std::unordered_map<const void*, std::vector<BoundExpression>>;
  ExpressionCollector(const Scope& scope, LengthUnit unit, const Report& report, Bound& bound)
      : scope_(scope), unit_(unit), report_(report), bound_(bound) {}

  [[nodiscard]] bool ok() const { return ok_; }

  template <class E>
  void add(const E& element) {
    const ElementId outer = element_;
    element_ = element.id_in_source;
    describe(*this, element);
    element_ = outer;
  }
  void add(const CsgNode& node) { add_alternative(node.value); }

  // The visitor's side of describe.hpp.
  template <class T>
  void attribute(std::string_view, const T&) {}
  template <class T>
  void attribute(std::string_view name, const std::optional<T>& value) {
    if (value) attribute(name, *value);
  }
  void attribute(std::string_view name, const Expression& value) {
    if (name == "nodeRadius" && value.text == "auto") return;
    auto bound = scope_.bind(value.text, {element_, name}, unit_, report_);
    ok_ = ok_ && bound.has_value();
    if (bound) bound_[&value] = {std::move(*bound)};
  }
  void attribute(std::string_view name, const ExpressionList& value) {
    const std::size_t count = name == "matrix" ? matrix_entries : expr::split_list(value.text).size();
    auto bound = scope_.bind_list(value.text, {element_, name}, count, unit_, report_);
    ok_ = ok_ && bound.has_value();
    if (bound) bound_[&value] = std::move(*bound);
  }
  void text(const std::string&) {}
  template <class E>
  void child(std::string_view, const E& element) {
    add(element);
  }
  template <class E>
  void child(std::string_view, const std::optional<E>& element) {
    if (element) add(*element);
  }
  template <class E>
  void children(std::string_view, const std::vector<E>& elements) {
    for (const E& element : elements) add(element);
  }
  template <class E>
  void sequence(const std::vector<E>& elements) {
    for (const E& element : elements) add(element);
  }
  template <class V>
  void add_alternative(const V& variant) {
    std::visit(
        [&](const auto& alternative) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(alternative)>, std::monostate>) add(alternative);
        },
        variant);
  }

 private:
  const Scope& scope_;
  LengthUnit unit_;
  const Report& report_;
  Bound& bound_;
  ElementId element_;
  bool ok_ = true;
};

/// The fields of implicit bodies are functions of a point; the implicit engine compiles them.
void add_body(ExpressionCollector& collector, const CellBody& body) {
  if (!std::holds_alternative<ImplicitBody>(body)) collector.add_alternative(body);
}

}  // namespace

std::optional<BodyTable> BodyTable::make(const EvaluationData& data, const Macrostructure& macrostructure,
                                         const Scope& scope, const Report& report) {
  BodyTable table;
  ExpressionCollector collector(scope, data.unit(), report, table.bound_);
  collector.add_alternative(macrostructure.body);
  if (!collector.ok()) return std::nullopt;
  return table;
}

std::optional<BodyTable> BodyTable::make(const EvaluationData& data, const UnitCell& cell, const Scope& scope,
                                         const Report& report) {
  BodyTable table;
  ExpressionCollector collector(scope, data.unit(), report, table.bound_);
  if (cell.box) collector.add(*cell.box);
  add_body(collector, cell.body);
  if (!collector.ok()) return std::nullopt;
  return table;
}

}  // namespace meso::eval
