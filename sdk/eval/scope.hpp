// SPDX-License-Identifier: Apache-2.0
#pragma once
// Names and what stands behind them: from the text of an expression to one that reads numbered slots.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/unit.hpp"
#include "meso/expr/expression.hpp"
#include "meso/model/source_map.hpp"

namespace meso::eval {

/// An attribute of the document, and where in its value an expression begins.
struct Place {
  ElementId element;
  std::string_view attribute;
  std::size_t offset = 0;
};

/// A sink that knows the document's places, and which cell the work is at.
struct Report {
  const SourceMap& source;
  DiagnosticSink& sink;
  std::vector<Related> related{};  ///< "in cell (1, 2, 3)" of every diagnostic, if there is a cell

  void operator()(Code code, const Place& place, std::vector<std::string> args) const {
    at(code, place, 0, 0, std::move(args));
  }
  /// `length` bytes from `offset` within the expression; length 0 = the whole attribute.
  void at(Code code, const Place& place, std::size_t offset, std::size_t length, std::vector<std::string> args) const;
};

/// Level of what never changes; a value of level k changes at most when loop k or one further out moves on.
inline constexpr int constant_level = -1;

struct BoundExpression {
  expr::Expression expression;
  int level = constant_level;
  Place place;

  [[nodiscard]] expr::EvalResult evaluate(std::span<const double> slots) const {
    return expr::evaluate(expression, slots);
  }
  [[nodiscard]] bool names(std::string_view name) const;
};

/// The names that an expression at some place may use.
class Scope {
 public:
  /// Later meanings of a name replace earlier ones.
  void define(std::string_view name, std::uint32_t slot, int level);

  [[nodiscard]] std::optional<BoundExpression> bind(std::string_view text, const Place& place, LengthUnit unit,
                                                    const Report& report) const;
  /// Every item of a comma-separated list; `count` items are expected.
  [[nodiscard]] std::optional<std::vector<BoundExpression>> bind_list(std::string_view text, const Place& place,
                                                                      std::size_t count, LengthUnit unit,
                                                                      const Report& report) const;

 private:
  struct Entry {
    std::uint32_t slot;
    int level;
  };
  std::map<std::string, Entry, std::less<>> entries_;
};

/// ", did you mean 'pitch'?" or nothing.
[[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace meso::eval
