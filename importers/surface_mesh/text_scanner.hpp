// SPDX-License-Identifier: Apache-2.0
#pragma once
// Words and numbers of a text, and where they stand.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/diagnostic.hpp"

namespace meso {

class TextScanner {
 public:
  /// `comment` begins a remark that ends with its line; '\0' for none.
  TextScanner(std::string_view text, std::string file, char comment)
      : text_(text), file_(std::move(file)), comment_(comment) {}

  /// Empty at the end of the text.
  std::string_view word();
  /// Empty at the end of the line.
  std::string_view word_on_line();
  void skip_line();

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - at_; }

  /// At the word read last.
  [[nodiscard]] Diagnostic fault(Code code, std::vector<std::string> args) const {
    return fault_at(word_, code, std::move(args));
  }
  /// At any word of the text.
  [[nodiscard]] Diagnostic fault_at(std::string_view word, Code code, std::vector<std::string> args) const;
  /// "expected ..., found" that word.
  [[nodiscard]] Diagnostic expected(std::string what) const;

 private:
  void skip_blanks();

  std::string_view text_;
  std::string file_;
  char comment_;
  std::size_t at_ = 0;
  std::string_view word_;
};

/// The whole word, or nothing. Numbers too small for a double are 0; too large ones and words for infinity and NaN
/// are not finite.
[[nodiscard]] std::optional<double> to_number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> to_integer(std::string_view word);

}  // namespace meso
