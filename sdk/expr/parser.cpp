// SPDX-License-Identifier: Apache-2.0
// Precedence climbing over the tokens. Nodes are written when their last operand is, so the flat tree comes out in
// evaluation order and nothing is rearranged afterwards.
#include <algorithm>
#include <array>
#include <cassert>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "functions.hpp"
#include "lexer.hpp"
#include "meso/expr/expression.hpp"

namespace meso::expr {
namespace {

/// loosest first.
enum Level : std::uint8_t { conditional, disjunction, conjunction, negation, comparison, sum, product, minus, power };

struct Infix {
  std::string_view symbol;
  Level level;
  Level right;  ///< the loosest operator that the right operand may have outside parentheses
  Op op;
};

constexpr std::array infixes = {
    Infix{"?", conditional, conditional, Op::select},
    Infix{"or", disjunction, conjunction, Op::logical_or},
    Infix{"and", conjunction, negation, Op::logical_and},
    Infix{"<", comparison, sum, Op::less},
    Infix{"<=", comparison, sum, Op::less_equal},
    Infix{">", comparison, sum, Op::greater},
    Infix{">=", comparison, sum, Op::greater_equal},
    Infix{"==", comparison, sum, Op::equal},
    Infix{"!=", comparison, sum, Op::not_equal},
    Infix{"+", sum, product, Op::add},
    Infix{"-", sum, product, Op::subtract},
    Infix{"*", product, minus, Op::multiply},
    Infix{"/", product, minus, Op::divide},
    Infix{"^", power, minus, Op::power},
};

const Infix* find_infix(const Token& token) {
  const auto* const found =
      std::find_if(infixes.begin(), infixes.end(), [&](const Infix& i) { return token.is(i.symbol); });
  return found == infixes.end() ? nullptr : found;
}

bool is_word(std::string_view text) { return text == "and" || text == "or" || text == "not"; }

std::string shown(const Token& token) {
  return token.kind == TokenKind::end ? "the end" : "'" + std::string(token.text) + "'";
}

}  // namespace

class Parser {
 public:
  Parser(std::string_view text, LengthUnit unit) : text_(text), lexer_(text, unit) {}

  ParseResult run() {
    if (parse_whole()) {
      expression_.text_ = std::string(text_);
      return {.expression = std::move(expression_), .error = std::nullopt};
    }
    return {.expression = std::nullopt, .error = std::move(error_)};
  }

 private:
  bool parse_whole();
  bool parse(Level loosest);
  bool parse_prefix(Level loosest);
  bool parse_prefix_operator(Op op, Level operand);
  bool parse_name();
  bool parse_call(const Token& name);
  bool parse_parenthesis();
  bool parse_infix(const Infix& infix, std::size_t begin);
  bool parse_conditional(std::size_t begin);
  bool parse_lazy(const Infix& infix, std::size_t begin);
  bool close_parenthesis(const Token& open);
  bool reject_after_value();

  bool advance();
  bool enter(const Token& token);
  bool fail(Code code, std::size_t offset, std::size_t length, std::vector<std::string> args);
  bool fail_at(const Token& token, Code code, std::vector<std::string> args) {
    return fail(code, token.offset, token.text.size(), std::move(args));
  }
  void emit(Op op, std::size_t operands, std::size_t begin, double number = 0, std::size_t index = 0);
  std::size_t emit_skip(Op op);
  void land(std::size_t skip) { nodes()[skip].index = static_cast<std::uint32_t>(nodes().size()); }
  std::vector<Node>& nodes() { return expression_.nodes_; }

  std::string_view text_;
  Lexer lexer_;
  Token token_;     ///< the next one, not yet taken
  Token previous_;  ///< the one taken last
  std::size_t nesting_ = 0;
  std::unordered_map<std::string_view, std::size_t> name_index_;
  Expression expression_;
  ParseError error_;
};

bool Parser::parse_whole() {
  if (text_.size() > max_text_bytes)
    return fail(Code::expression_too_long, 0, text_.size(),
                {std::to_string(text_.size()), std::to_string(max_text_bytes)});
  if (!advance()) return false;
  if (token_.kind == TokenKind::end) return fail(Code::expression_empty, 0, text_.size(), {});
  if (!parse(conditional)) return false;
  return token_.kind == TokenKind::end || reject_after_value();
}

bool Parser::parse(Level loosest) {
  const std::size_t begin = token_.offset;
  if (!parse_prefix(loosest)) return false;
  for (const Infix* infix = find_infix(token_); infix != nullptr && infix->level >= loosest; infix = find_infix(token_))
    if (!parse_infix(*infix, begin)) return false;
  return true;
}

bool Parser::parse_prefix(Level loosest) {
  if (token_.is("-")) return parse_prefix_operator(Op::negate, minus);
  if (token_.is("not") && loosest <= negation) return parse_prefix_operator(Op::logical_not, negation);
  if (token_.is("(")) return parse_parenthesis();
  if (token_.kind == TokenKind::name && !is_word(token_.text)) return parse_name();
  if (token_.kind == TokenKind::number) {
    const double value = token_.value;
    const std::size_t begin = token_.offset;
    if (!advance()) return false;
    emit(Op::number, 0, begin, value);
    return true;
  }
  if (token_.is(")") && nesting_ == 0) return reject_after_value();
  return fail_at(token_, Code::expression_missing_operand, {shown(token_)});
}

bool Parser::parse_prefix_operator(Op op, Level operand) {
  const Token sign = token_;
  if (!enter(sign) || !advance() || !parse(operand)) return false;
  --nesting_;
  emit(op, 1, sign.offset);
  return true;
}

bool Parser::parse_parenthesis() {
  const Token open = token_;
  if (!enter(open) || !advance() || !parse(conditional) || !close_parenthesis(open)) return false;
  --nesting_;
  return true;
}

bool Parser::close_parenthesis(const Token& open) {
  if (token_.is(")")) return advance();
  if (token_.kind == TokenKind::end) return fail_at(open, Code::expression_unbalanced, {"(", ")"});
  return reject_after_value();
}

bool Parser::parse_name() {
  const Token name = token_;
  if (lexer_.peek() == '(') return parse_call(name);
  if (find_function(name.text) != nullptr)
    return fail_at(name, Code::expression_bare_function, {std::string(name.text)});
  if (!advance()) return false;
  if (name.text == "pi") {
    emit(Op::number, 0, name.offset, std::numbers::pi);
    return true;
  }
  const auto [known, is_new] = name_index_.try_emplace(name.text, expression_.names_.size());
  if (is_new)
    expression_.names_.push_back(
        {std::string(name.text), static_cast<std::uint32_t>(name.offset), static_cast<std::uint32_t>(known->second)});
  emit(Op::name, 0, name.offset, 0, known->second);
  return true;
}

bool Parser::parse_call(const Token& name) {
  const Function* const function = find_function(name.text);
  if (function == nullptr)
    return fail_at(name, Code::expression_unknown_function,
                   {std::string(name.text), suggestion(name.text, function_names())});
  if (!advance() || !enter(token_)) return false;
  const Token open = token_;
  if (!advance()) return false;
  std::size_t count = 0;
  const bool folds = function->op == Op::min || function->op == Op::max;
  std::vector<std::size_t> fold_ends;
  while (!(count == 0 && token_.is(")"))) {
    if (!parse(conditional)) return false;
    ++count;
    // min(a, b, c) is min(min(a, b), c). Every step of the fold stands for the call as a whole; its end comes below.
    if (folds && count > 1) {
      fold_ends.push_back(nodes().size());
      emit(function->op, 2, name.offset);
    }
    if (!token_.is(",")) break;
    if (!advance()) return false;
  }
  if (!close_parenthesis(open)) return false;
  --nesting_;
  if (count < function->min_arguments || count > function->max_arguments)
    return fail(Code::expression_argument_count, name.offset, previous_.end() - name.offset,
                {std::string(name.text), describe_arguments(*function), std::to_string(count)});
  for (const std::size_t step : fold_ends)
    nodes()[step].length = static_cast<std::uint32_t>(previous_.end() - name.offset);
  if (!folds) emit(function->op, count, name.offset);
  return true;
}

bool Parser::parse_infix(const Infix& infix, std::size_t begin) {
  if (infix.level == conditional) return parse_conditional(begin);
  if (infix.level == disjunction || infix.level == conjunction) return parse_lazy(infix, begin);
  const Token sign = token_;
  // The exponent is to the right, and so are its exponents: the one infix operator that nests without parentheses.
  const bool nests = infix.level == power;
  if ((nests && !enter(sign)) || !advance() || !parse(infix.right)) return false;
  if (nests) --nesting_;
  emit(infix.op, 2, begin);
  const Infix* const next = find_infix(token_);
  if (infix.level == comparison && next != nullptr && next->level == comparison)
    return fail_at(token_, Code::expression_chained_comparison, {std::string(token_.text)});
  return true;
}

bool Parser::parse_conditional(std::size_t begin) {
  const Token question = token_;
  if (!enter(question) || !advance()) return false;
  const std::size_t to_second = emit_skip(Op::skip_if_zero);
  if (!parse(conditional)) return false;
  if (token_.kind == TokenKind::end || token_.is(")") || token_.is(","))
    return fail_at(question, Code::expression_unbalanced, {"?", ":"});
  if (!token_.is(":")) return reject_after_value();
  if (!advance()) return false;
  const std::size_t to_end = emit_skip(Op::skip);
  land(to_second);
  if (!parse(conditional)) return false;
  land(to_end);
  --nesting_;
  emit(Op::select, 3, begin);
  return true;
}

bool Parser::parse_lazy(const Infix& infix, std::size_t begin) {
  if (!advance()) return false;
  const std::size_t past = emit_skip(infix.op == Op::logical_and ? Op::and_skip : Op::or_skip);
  if (!parse(infix.right)) return false;
  emit(infix.op, 2, begin);
  land(past);
  return true;
}

/// The value before token_ is complete, and token_ cannot go on from it.
bool Parser::reject_after_value() {
  if (token_.is(")")) return fail_at(token_, Code::expression_unbalanced, {")", "("});
  if (token_.is(":")) return fail_at(token_, Code::expression_unbalanced, {":", "?"});
  if (token_.is(",")) return fail_at(token_, Code::expression_unexpected_character, {","});
  const bool bare_number = previous_.kind == TokenKind::number && !previous_.has_unit;
  if (bare_number && token_.kind == TokenKind::name && find_suffix(token_.text))
    return fail_at(token_, Code::expression_unit_apart, {std::string(token_.text)});
  // A letter or two are more often a name than a mistyped unit.
  const bool maybe_unit = bare_number && token_.kind == TokenKind::name && token_.text.size() > 2;
  return fail_at(token_, Code::expression_missing_operator,
                 {shown(token_) + (maybe_unit ? unit_suggestion(token_.text) : "")});
}

bool Parser::advance() {
  std::optional<Token> next = lexer_.next();
  if (!next) {
    error_ = lexer_.error();
    return false;
  }
  previous_ = token_;
  token_ = *next;
  return true;
}

bool Parser::enter(const Token& token) {
  if (++nesting_ <= max_nesting) return true;
  return fail_at(token, Code::expression_too_deep, {std::to_string(max_nesting)});
}

bool Parser::fail(Code code, std::size_t offset, std::size_t length, std::vector<std::string> args) {
  error_ = ParseError{code, offset, length, std::move(args)};
  return false;
}

void Parser::emit(Op op, std::size_t operands, std::size_t begin, double number, std::size_t index) {
  nodes().push_back({op, static_cast<std::uint8_t>(operands), static_cast<std::uint32_t>(index),
                     static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(previous_.end() - begin), number});
}

std::size_t Parser::emit_skip(Op op) {
  nodes().push_back({.op = op});
  return nodes().size() - 1;
}

ParseResult parse_expression(std::string_view text, LengthUnit document_unit) {
  return Parser(text, document_unit).run();
}

Expression Expression::bind(std::span<const std::uint32_t> slot_of_name) const {
  assert(slot_of_name.size() == names_.size());
  Expression bound = *this;
  std::unordered_map<std::string_view, std::uint32_t> slot;
  for (std::size_t k = 0; k < names_.size(); ++k) {
    bound.names_[k].slot = slot_of_name[k];
    slot[names_[k].text] = slot_of_name[k];
  }
  for (Node& node : bound.nodes_)
    if (node.op == Op::name) node.index = slot.at(std::string_view(text_).substr(node.offset, node.length));
  return bound;
}

std::vector<ListItem> split_list(std::string_view text) {
  std::vector<ListItem> items;
  std::size_t begin = 0;
  std::size_t depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')' && depth > 0) --depth;
    if (text[i] != ',' || depth > 0) continue;
    items.push_back({text.substr(begin, i - begin), begin});
    begin = i + 1;
  }
  items.push_back({text.substr(begin), begin});
  return items;
}

}  // namespace meso::expr
