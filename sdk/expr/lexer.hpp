// SPDX-License-Identifier: Apache-2.0
#pragma once
// Cuts an expression into tokens, one at a time (docs/specification/expressions.md, section 7.3).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "literal.hpp"
#include "meso/expr/expression.hpp"

namespace meso::expr {

enum class TokenKind : std::uint8_t { end, number, name, symbol };

struct Token {
  TokenKind kind = TokenKind::end;
  std::size_t offset = 0;
  std::string_view text{};  ///< a number with its unit; a name, dotted ones whole; a word; an operator
  double value = 0;         ///< of a number
  bool has_unit = false;    ///< of a number

  [[nodiscard]] bool is(std::string_view symbol_or_word) const {
    return (kind == TokenKind::symbol || kind == TokenKind::name) && text == symbol_or_word;
  }
  [[nodiscard]] std::size_t end() const { return offset + text.size(); }
};

class Lexer {
 public:
  Lexer(std::string_view text, LengthUnit document_unit) : text_(text), unit_(document_unit) {}

  /// The next token, or nothing and error() says why. After an error: do not call again.
  [[nodiscard]] std::optional<Token> next();
  [[nodiscard]] const ParseError& error() const { return error_; }
  /// The byte that the next token begins with; 0 at the end.
  [[nodiscard]] char peek();

 private:
  std::optional<Token> number();
  std::optional<Token> name();
  std::optional<Token> symbol();
  std::optional<Token> fail(Code code, std::size_t offset, std::size_t length, std::vector<std::string> args);
  [[nodiscard]] char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

  std::string_view text_;
  LengthUnit unit_;
  std::size_t at_ = 0;
  ParseError error_;
};

/// "; did you mean 'floor'?" or nothing: the tail of messages about unknown words.
[[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);
/// The same for a word where a unit stands: "; did you mean 'mm'?" for "milimeter", too.
[[nodiscard]] std::string unit_suggestion(std::string_view word);

}  // namespace meso::expr
