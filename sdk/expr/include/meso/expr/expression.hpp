// SPDX-License-Identifier: Apache-2.0
#pragma once
// Expressions of documents: the grammar's one parser, its tree, and the plain walk that gives the tree a value. The
// rules are docs/specification/expressions.md.
//
//   ParseResult r = parse_expression("ceil(50mm / pitch)", LengthUnit::millimeter);
//   if (!r.expression) report(r.error->code, r.error->offset, r.error->args);
//   // names() is {"pitch"}; slot 0 holds its value until bind() says otherwise
//   const double values[] = {5};
//   EvalResult e = evaluate(*r.expression, values);        // e.value == 10
//
// Lengths are in the document's unit, angles in radians, truth is 1 or 0 (anything but 0 is true). Offsets and lengths
// count bytes of the expression's text. Expressions are values and never change: share them between threads freely.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/unit.hpp"

namespace meso::expr {

inline constexpr std::size_t max_text_bytes = 65536;  ///< R-7.1.2
inline constexpr std::size_t max_nesting = 200;       ///< R-7.1.3

enum class Op : std::uint8_t {
  number,  ///< leaf; Node::number (units converted; `pi` too)
  name,    ///< leaf; Node::index is the slot
  negate,
  logical_not,
  add,
  subtract,
  multiply,
  divide,
  power,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  floor,
  ceil,
  round,
  abs,
  sign,
  sqrt,
  exp,
  log,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  mod,
  atan2,
  hypot,
  min,  ///< two operands: min(a, b, c) is min(min(a, b), c); min(a) leaves no node of its own
  max,
  clamp,
  hash,         ///< one to eight operands
  logical_and,  ///< two operands, the second may be skipped
  logical_or,
  select,        ///< condition ? first : second; three operands, of which one is skipped
  skip_if_zero,  ///< walk only: take a value off; if it is 0 go on at node `index`
  skip,          ///< walk only: go on at node `index`
  and_skip,      ///< walk only: if the top value is 0 make it +0 and go on at node `index`, else take it off
  or_skip,       ///< walk only: if the top value is not 0 replace it by 1 and go on at `index`, else take it off
};

/// The tree, flattened in evaluation order: operands stand before their operation, left to right. Two readings:
///  * as a tree: ignore the four `skip` nodes; every other node takes `operands` subtrees off a stack of subtrees;
///  * as a walk with lazy branches: obey the skips; `select` then does nothing (its one value is there already), and
///    `logical_and`, `logical_or` turn the top value into 1 or 0.
struct Node {
  Op op{};
  std::uint8_t operands = 0;
  std::uint32_t index = 0;
  std::uint32_t offset = 0;  ///< of the whole subexpression
  std::uint32_t length = 0;
  double number = 0;
  friend bool operator==(const Node&, const Node&) = default;
};

/// A distinct name of an expression, dotted ones (`global.x`, `stress.s1`) whole, and the place of its first use.
struct Name {
  std::string text;
  std::uint32_t offset = 0;
  std::uint32_t slot = 0;
  friend bool operator==(const Name&, const Name&) = default;
};

class Expression {
 public:
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// In order of first use. As parsed, slot k belongs to names()[k].
  [[nodiscard]] const std::vector<Name>& names() const { return names_; }
  [[nodiscard]] bool is_constant() const { return names_.empty(); }

  /// The same expression whose names()[k] reads slot `slot_of_name[k]`. REQUIRES: one slot per name.
  [[nodiscard]] Expression bind(std::span<const std::uint32_t> slot_of_name) const;

  friend bool operator==(const Expression&, const Expression&) = default;

 private:
  friend class Parser;
  Expression() = default;

  std::string text_;
  std::vector<Node> nodes_;
  std::vector<Name> names_;
};

/// One clear fault per text: the first from the left. `code` is one of EXPRESSION_*; `args` fill its message.
struct ParseError {
  Code code{};
  std::size_t offset = 0;
  std::size_t length = 0;
  std::vector<std::string> args{};
  friend bool operator==(const ParseError&, const ParseError&) = default;
};

/// Exactly one of the two is there.
struct ParseResult {
  std::optional<Expression> expression;
  std::optional<ParseError> error;
};

/// Any bytes are fine as `text`. Linear in its size, except that the digits of a literal with a unit are converted
/// exactly, which is quadratic in their number (a few milliseconds at the limit). Needs at most 512 KiB of stack. Which
/// names exist is not the parser's business: ask names().
[[nodiscard]] ParseResult parse_expression(std::string_view text, LengthUnit document_unit);

/// A finite value, or the subexpression whose operation has none (EXPRESSION_DOMAIN; its text is the argument).
struct EvalResult {
  double value = 0;
  std::uint32_t failed_offset = 0;
  std::uint32_t failed_length = 0;  ///< 0: there is a value

  [[nodiscard]] explicit operator bool() const { return failed_length == 0; }
};

/// The plain walk: no allocation, one step per node, untaken branches are not evaluated.
/// REQUIRES: a finite value in every slot that a name of the expression reads.
[[nodiscard]] EvalResult evaluate(const Expression& expression, std::span<const double> slots);

/// One item of a comma-separated list and where it starts.
struct ListItem {
  std::string_view text;
  std::size_t offset = 0;
};

/// Splits at the commas that stand outside parentheses; k commas give k + 1 items, which may be empty. Spaces stay.
[[nodiscard]] std::vector<ListItem> split_list(std::string_view text);

/// [A-Za-z_][A-Za-z0-9_]*
[[nodiscard]] bool is_valid_name(std::string_view text);
/// Functions, `pi`, `and`, `or`, `not`, `global`: names that nothing in a document may take.
[[nodiscard]] bool is_reserved_name(std::string_view text);

}  // namespace meso::expr
