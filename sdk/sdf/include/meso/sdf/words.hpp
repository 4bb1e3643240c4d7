// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words of a program in the Cesogen language, each with the place it stands at.
//
//   const std::vector<Word> a = words_of_arguments(arguments);                 // a command line: one word each
//   const auto b = words_of_text("ball shell 0.2  # thin", "part.txt", sink);  // a file's text: ball, shell, 0.2
//
// In a text, white space separates words, '...' and "..." hold words together that contain any, and # at the beginning
// of a word comments out the rest of the line; a byte order mark of UTF-8 is passed over. Errors: SDF_QUOTE. Words are
// values; threads may share them.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/diagnostic.hpp"

namespace meso::sdf {

/// Where words come from: the command line, joined by spaces, or a file's text.
struct WordSource {
  std::string name;  ///< of the file as it was asked for; empty: the command line
  std::string text;
};

struct Word {
  std::string text;
  std::size_t number = 0;  ///< 1 is its source's first
  std::size_t offset = 0;  ///< bytes in the source's text
  std::size_t length = 0;
  std::shared_ptr<const WordSource> source{};
};

[[nodiscard]] std::vector<Word> words_of_arguments(std::span<const std::string> arguments);
[[nodiscard]] std::optional<std::vector<Word>> words_of_text(std::string text, std::string name, DiagnosticSink& sink);

/// Points at `length` bytes from byte `offset` of a word (all of it: 0, npos): file, line, column, and as a related
/// note the line with a caret below. Where the word was quoted the caret covers all of it.
/// Nothing where the word has no source.
void point_at(Diagnostic& diagnostic, const Word& word, std::size_t offset = 0,
              std::size_t length = std::string_view::npos);

}  // namespace meso::sdf
