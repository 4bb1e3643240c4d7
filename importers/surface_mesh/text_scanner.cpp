// SPDX-License-Identifier: Apache-2.0
#include "text_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace meso {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

}  // namespace

void TextScanner::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  if (at_ < text_.size() && comment_ != '\0' && text_[at_] == comment_)
    at_ = std::min(text_.find('\n', at_), text_.size());
}

std::string_view TextScanner::word_on_line() {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n') ++at_;
  return word_ = text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::word() {
  while (word_on_line().empty() && at_ < text_.size()) ++at_;
  return word_;
}

void TextScanner::skip_line() { at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1; }

Diagnostic TextScanner::fault_at(std::string_view word, Code code, std::vector<std::string> args) const {
  Diagnostic d{.code = code, .where = {.file = file_}, .args = std::move(args)};
  const auto offset = static_cast<std::size_t>(word.data() - text_.data());
  const std::string_view before = text_.substr(0, offset);
  d.where.offset = offset;
  d.where.length = word.size();
  d.where.line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  d.where.column = offset - (before.find_last_of('\n') + 1) + 1;  // npos + 1 is 0
  return d;
}

Diagnostic TextScanner::expected(std::string what) const {
  const bool at_end = static_cast<std::size_t>(word_.data() - text_.data()) >= text_.size();
  const std::string found = !word_.empty() ? std::string(word_.substr(0, 40))
                            : at_end       ? "the end of the file"
                                           : "the end of the line";
  return fault(Code::mesh_file_syntax, {std::move(what), found});
}

std::optional<double> to_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return {};
  if (error == std::errc{}) return value;
  const bool tiny = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
  return tiny ? 0 : HUGE_VAL;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc{}) return {};
  return value;
}

}  // namespace meso
