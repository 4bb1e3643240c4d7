// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/file_cursor.hpp"

#include <algorithm>
#include <charconv>

namespace meso::fields {
namespace {

constexpr std::size_t longest_quote = 40;    // bytes of the file in a message
constexpr std::uint64_t poll_mask = 0xFFFF;  // words and lines between two looks at the clock

bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  return text;
}

template <class T>
bool parse(std::string_view text, T& value) {
  text = without_blanks(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

bool parse_field_number(std::string_view text, double& value) { return parse(text, value); }
bool parse_field_integer(std::string_view text, std::int64_t& value) { return parse(text, value); }

void FileCursor::skip_space() {
  while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
}

void FileCursor::poll() {
  if ((++steps_ & poll_mask) == 0) (void)is_stopped();
}

bool FileCursor::is_stopped() {
  if (!is_stopped_ && run_.should_stop()) stop({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
  return is_stopped_;
}

void FileCursor::stop(Diagnostic reason) {
  sink_.report(std::move(reason));
  is_stopped_ = true;
  at_ = bytes_.size();
}

bool FileCursor::takes(std::uint64_t bytes) {
  poll();
  if (is_stopped_) return false;
  held_ += bytes;
  if (bytes <= run_.max_memory_bytes && held_ <= run_.max_memory_bytes) return true;
  stop({.code = Code::limit_memory, .args = {std::to_string(run_.max_memory_bytes >> 20) + " MiB"}});
  return false;
}

std::string_view FileCursor::line() {
  poll();
  last_ = std::min(at_, bytes_.size());
  const std::size_t end = std::min(bytes_.find('\n', last_), bytes_.size());
  std::string_view text = bytes_.substr(last_, end - last_);
  if (text.ends_with('\r')) text.remove_suffix(1);
  at_ = std::min(end + 1, bytes_.size());
  return text;
}

std::string_view FileCursor::word() {
  poll();
  skip_space();
  last_ = at_;
  while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
  return bytes_.substr(last_, at_ - last_);
}

std::string_view FileCursor::peek() const {
  std::size_t begin = at_;
  while (begin < bytes_.size() && is_space(bytes_[begin])) ++begin;
  std::size_t end = begin;
  while (end < bytes_.size() && !is_space(bytes_[end])) ++end;
  return begin < bytes_.size() ? bytes_.substr(begin, end - begin) : std::string_view();
}

std::string_view FileCursor::block(std::uint64_t size, std::string_view what) {
  poll();
  last_ = std::min(at_, bytes_.size());
  if (is_stopped_) return {};
  if (size > bytes_.size() - last_) {
    sink_.report({.code = Code::field_file_truncated,
                  .where = here(),
                  .args = {"after " + std::to_string(bytes_.size() - last_) + " of " + std::to_string(size) +
                           " bytes of " + std::string(what)}});
    return {};
  }
  at_ = last_ + static_cast<std::size_t>(size);
  return bytes_.substr(last_, static_cast<std::size_t>(size));
}

bool FileCursor::number(double& value) { return parse(word(), value) || expected("a number"); }
bool FileCursor::integer(std::int64_t& value) { return parse(word(), value) || expected("a whole number"); }
bool FileCursor::count(std::int64_t& value, std::int64_t largest) {
  return (parse(word(), value) && value >= 0 && value <= largest) ||
         expected("a count of at most " + std::to_string(largest));
}

bool FileCursor::expected(std::string what) {
  if (is_stopped_) return false;
  const bool is_cut = last_ > 0 && bytes_.find('\n', last_) == std::string_view::npos;
  if (last_ >= bytes_.size() || is_cut) {
    sink_.report({.code = Code::field_file_truncated, .where = here(), .args = {"where " + what + " should be"}});
    return false;
  }
  const std::size_t end = std::min(bytes_.find('\n', last_), bytes_.size());
  std::string found(bytes_.substr(last_, std::min(longest_quote, end - last_)));
  std::replace_if(
      found.begin(), found.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
  sink_.report({.code = Code::field_file_syntax, .where = here(), .args = {std::move(what), std::move(found)}});
  return false;
}

bool FileCursor::unsupported(std::string what) {
  if (is_stopped_) return false;
  sink_.report({.code = Code::field_file_unsupported, .where = here(), .args = {std::move(what)}});
  return false;
}

bool FileCursor::empty(std::string what) {
  if (is_stopped_) return false;
  sink_.report({.code = Code::field_file_empty, .where = {.file = file_}, .args = {std::move(what)}});
  return false;
}

void FileCursor::left_out(std::string what) {
  sink_.report({.code = Code::field_left_out, .where = {.file = file_}, .args = {std::move(what)}});
}

SourceSpan FileCursor::here() const {
  const std::string_view before = bytes_.substr(0, last_);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 == 0
  return {.file = file_,
          .offset = last_,
          .length = 1,
          .line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1,
          .column = last_ - line_start + 1};
}

}  // namespace meso::fields
