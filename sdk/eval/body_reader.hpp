// SPDX-License-Identifier: Apache-2.0
#pragma once
// Numbers of a body: evaluated, checked, in millimetres. A fault is reported once and makes ok() false; the value
// handed out then is a harmless 1, so that shapes are written without a test behind every number.

#include <cmath>

#include "body.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/operations.hpp"

namespace meso::eval {

class BodyReader {
 public:
  BodyReader(const EvaluationData& data, const BodyTable& table, std::span<const double> slots, const Report& report)
      : data_(data), table_(table), slots_(slots), report_(report) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] const EvaluationData& data() const { return data_; }
  [[nodiscard]] const Report& report() const { return report_; }

  void fail(Code code, const Place& place, std::vector<std::string> args) {
    if (ok_) report_(code, place, std::move(args));
    ok_ = false;
  }

  [[nodiscard]] double number(const Expression& e) {
    const BoundExpression& bound = table_.at(e);
    const auto value = ok_ ? evaluate(bound, slots_, report_) : std::nullopt;
    ok_ = value.has_value();
    return value.value_or(1);
  }
  [[nodiscard]] double length(const Expression& e) { return data_.millimeters() * number(e); }
  [[nodiscard]] double length(const std::optional<Expression>& e) { return e ? length(*e) : 0; }
  [[nodiscard]] double positive(const Expression& e) {
    const double value = number(e);
    if (value > 0) return value;
    fail(Code::value_not_positive, place(e), {std::string(place(e).attribute), format_number(value)});
    return 1;
  }
  [[nodiscard]] double positive_length(const Expression& e) { return data_.millimeters() * positive(e); }
  [[nodiscard]] double length_not_negative(const Expression& e) {
    const double value = number(e);
    if (value < 0) fail(Code::value_negative, place(e), {std::string(place(e).attribute), format_number(value)});
    return data_.millimeters() * value;
  }
  /// Whole numbers from 0 (R-7.5.3 decides what is one).
  [[nodiscard]] std::vector<std::size_t> indices(const ExpressionList& list) {
    std::vector<std::size_t> result;
    for (const BoundExpression& item : table_.at(list)) {
      const auto value = ok_ ? evaluate(item, slots_, report_) : std::nullopt;
      ok_ = value.has_value();
      const double n = expr::snap_to_integer(value.value_or(0));
      if (!(n == std::round(n) && n >= 0 && n <= 0x1p53))
        fail(Code::value_not_whole, item.place, {"vertices", "0", format_number(n)});
      else
        result.push_back(static_cast<std::size_t>(n));
    }
    return result;
  }
  /// A 3x4 matrix in millimetres whose determinant keeps the rule of `mirror`.
  [[nodiscard]] Affine affine(const ExpressionList& list, bool mirror) {
    const std::vector<BoundExpression>& items = table_.at(list);
    std::array<double, 12> rows{};
    for (std::size_t i = 0; i < rows.size() && ok_; ++i) {
      const auto value = evaluate(items[i], slots_, report_);
      ok_ = value.has_value();
      rows[i] = value.value_or(1);
    }
    Affine map = Affine::from_rows(rows);
    ok_ = ok_ && check_determinant(map.linear, mirror, {items[0].place.element, items[0].place.attribute}, report_);
    map.translation = data_.millimeters() * map.translation;
    return map;
  }

  [[nodiscard]] const Place& place(const Expression& e) const { return table_.at(e).place; }

 private:
  const EvaluationData& data_;
  const BodyTable& table_;
  std::span<const double> slots_;
  const Report& report_;
  bool ok_ = true;
};

}  // namespace meso::eval
