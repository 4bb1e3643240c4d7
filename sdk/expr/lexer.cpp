// SPDX-License-Identifier: Apache-2.0
#include "lexer.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "meso/expr/nearest.hpp"

namespace meso::expr {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

constexpr std::array<std::string_view, 16> symbols = {"<=", ">=", "==", "!=", "+", "-", "*", "/",
                                                      "^",  "<",  ">",  "?",  ":", "(", ")", ","};

/// What people write out of habit from other languages, keyboards and text processors; longest first.
constexpr std::array<std::pair<std::string_view, std::string_view>, 27> foreign = {{
    {"===", "=="}, {"!==", "!="},    {"<>", "!="}, {"=<", "<="},       {"=>", ">="}, {"**", "^"}, {"&&", "and"},
    {"||", "or"},  {"&", "and"},     {"|", "or"},  {"%", "mod(x, y)"}, {"−", "-"},   {"–", "-"},  {"×", "*"},
    {"·", "*"},    {"⋅", "*"},       {"÷", "/"},   {"≤", "<="},        {"≥", ">="},  {"≠", "!="}, {"²", "^2"},
    {"³", "^3"},   {"√", "sqrt(x)"}, {"π", "pi"},  {"°", "deg"},       {"µ", "u"},   {"μ", "u"},
}};

/// Units as they are spelled in full.
constexpr std::array<std::pair<std::string_view, std::string_view>, 18> spelled = {{
    {"micrometer", "um"},
    {"micrometre", "um"},
    {"micron", "um"},
    {"millimeter", "mm"},
    {"millimetre", "mm"},
    {"centimeter", "cm"},
    {"centimetre", "cm"},
    {"meter", "m"},
    {"meters", "m"},
    {"metre", "m"},
    {"inch", "in"},
    {"inches", "in"},
    {"foot", "ft"},
    {"feet", "ft"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"radian", "rad"},
    {"radians", "rad"},
}};

/// The character at the front of `text`, whole if it is UTF-8; \xNN for what cannot be shown.
std::string show_character(std::string_view text, std::size_t& length) {
  const auto first = static_cast<unsigned char>(text[0]);
  length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
  const auto is_tail = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  const bool whole = length > 1 && first < 0xF8 && text.size() >= length &&
                     std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(length), is_tail);
  if (whole || (first >= 0x20 && first < 0x7F)) return std::string(text.substr(0, length));
  length = 1;
  constexpr std::string_view hex = "0123456789ABCDEF";
  return {'\\', 'x', hex[first / 16], hex[first % 16]};
}

}  // namespace

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string_view near = nearest(word, candidates);
  return near.empty() ? "" : "; did you mean '" + std::string(near) + "'?";
}

std::string unit_suggestion(std::string_view word) {
  if (std::string near = suggestion(word, suffix_names()); !near.empty()) return near;
  std::array<std::string_view, spelled.size()> names;
  std::ranges::transform(spelled, names.begin(), [](const auto& s) { return s.first; });
  const auto* const found = std::ranges::find(spelled, nearest(word, names), [](const auto& s) { return s.first; });
  return found == spelled.end() ? "" : "; did you mean '" + std::string(found->second) + "'?";
}

char Lexer::peek() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  return at(at_);
}

std::optional<Token> Lexer::next() {
  const char c = peek();
  if (at_ == text_.size()) return Token{.kind = TokenKind::end, .offset = at_};
  if (is_digit(c) || (c == '.' && is_digit(at(at_ + 1)))) return number();
  if (is_letter(c)) return name();
  return symbol();
}

std::optional<Token> Lexer::number() {
  std::size_t end = at_;
  while (is_digit(at(end))) ++end;
  if (at(end) == '.') ++end;
  while (is_digit(at(end))) ++end;
  if (at(end) == 'e' || at(end) == 'E') {
    const std::size_t digits = end + (at(end + 1) == '+' || at(end + 1) == '-' ? 2 : 1);
    if (is_digit(at(digits))) {
      end = digits;
      while (is_digit(at(end))) ++end;
    }
  }
  const std::string_view decimal = text_.substr(at_, end - at_);
  const std::size_t unit_begin = end;
  while (is_letter(at(end)) || (end > unit_begin && is_digit(at(end)))) ++end;
  const std::string_view unit = text_.substr(unit_begin, end - unit_begin);

  const std::optional<Suffix> suffix = unit.empty() ? Suffix::none : find_suffix(unit);
  if (!suffix)
    return fail(Code::expression_unknown_unit, unit_begin, unit.size(), {std::string(unit), unit_suggestion(unit)});
  const std::optional<double> value = literal_value(decimal, *suffix, unit_);
  const std::string_view whole = text_.substr(at_, end - at_);
  if (!value) return fail(Code::expression_number_range, at_, whole.size(), {std::string(whole)});
  const Token token{TokenKind::number, at_, whole, *value, !unit.empty()};
  at_ = end;
  return token;
}

std::optional<Token> Lexer::name() {
  const std::size_t begin = at_;
  const auto skip_word = [&] {
    while (is_letter(at(at_)) || is_digit(at(at_))) ++at_;
  };
  skip_word();
  if (at(at_) == '.' && is_letter(at(at_ + 1))) {
    ++at_;
    skip_word();
  }
  return Token{.kind = TokenKind::name, .offset = begin, .text = text_.substr(begin, at_ - begin)};
}

std::optional<Token> Lexer::symbol() {
  const std::string_view rest = text_.substr(at_);
  for (const auto& [theirs, ours] : foreign)
    if (rest.starts_with(theirs))
      return fail(Code::expression_foreign_symbol, at_, theirs.size(), {std::string(theirs), std::string(ours)});
  for (const std::string_view symbol : symbols) {
    if (!rest.starts_with(symbol)) continue;
    const Token token{.kind = TokenKind::symbol, .offset = at_, .text = rest.substr(0, symbol.size())};
    at_ += symbol.size();
    return token;
  }
  if (rest[0] == '=') return fail(Code::expression_assignment, at_, 1, {});
  if (rest[0] == '!') return fail(Code::expression_foreign_symbol, at_, 1, {"!", "not"});
  std::size_t length = 1;
  std::string shown = show_character(rest, length);
  return fail(Code::expression_unexpected_character, at_, length, {std::move(shown)});
}

std::optional<Token> Lexer::fail(Code code, std::size_t offset, std::size_t length, std::vector<std::string> args) {
  error_ = ParseError{code, offset, length, std::move(args)};
  return std::nullopt;
}

}  // namespace meso::expr
