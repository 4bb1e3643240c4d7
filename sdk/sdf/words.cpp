// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/words.hpp"

#include <algorithm>

namespace meso::sdf {
namespace {

constexpr std::string_view white_space = " \t\r\n\f\v";

bool is_white(char c) { return white_space.find(c) != std::string_view::npos; }

/// As a shell would have to be given it.
std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\r\n'\"()*#&;|<>$`\\") == std::string::npos) return word;
  return word.find('\'') == std::string::npos ? "'" + word + "'" : '"' + word + '"';
}

std::size_t code_points(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// The line around [offset, offset + length), cut to about 100 columns, and below it a caret.
std::string excerpt(std::string_view text, std::size_t offset, std::size_t length) {
  const std::size_t line_start = text.substr(0, offset).rfind('\n') + 1;  // npos + 1 is 0
  const std::size_t line_end = std::min(text.find('\n', offset), text.size());
  std::size_t first = offset - line_start > 60 ? offset - 40 : line_start;
  while (first < offset && (text[first] & 0xC0) == 0x80) ++first;
  std::size_t last = std::min(line_end, first + 100);
  while (last < line_end && (text[last] & 0xC0) == 0x80) ++last;
  const std::string before = first > line_start ? "..." : "";
  std::string line = before + std::string(text.substr(first, last - first)) + (last < line_end ? "..." : "");
  std::replace(line.begin(), line.end(), '\t', ' ');
  const std::size_t indent = before.size() + code_points(text.substr(first, offset - first));
  const std::size_t width = code_points(text.substr(offset, std::min(length, last - offset)));
  return line + "\n  " + std::string(indent, ' ') + '^' + std::string(width > 1 ? width - 1 : 0, '~');
}

}  // namespace

std::vector<Word> words_of_arguments(std::span<const std::string> arguments) {
  auto source = std::make_shared<WordSource>();
  std::vector<Word> words;
  for (const std::string& argument : arguments) {
    if (!words.empty()) source->text += ' ';
    const std::string shown = quoted(argument);
    words.push_back({.text = argument,
                     .number = words.size() + 1,
                     .offset = source->text.size(),
                     .length = shown.size(),
                     .source = source});
    source->text += shown;
  }
  return words;
}

std::optional<std::vector<Word>> words_of_text(std::string text, std::string name, DiagnosticSink& sink) {
  const auto source = std::make_shared<const WordSource>(WordSource{std::move(name), std::move(text)});
  const std::string& all = source->text;
  std::vector<Word> words;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  for (std::size_t i = all.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; i < all.size();) {
    if (is_white(all[i])) {
      ++i;
      continue;
    }
    if (all[i] == '#') {
      i = std::min(all.find('\n', i), all.size());
      continue;
    }
    Word word{.number = words.size() + 1, .offset = i, .source = source};
    while (i < all.size() && !is_white(all[i])) {
      if (all[i] != '\'' && all[i] != '"') {
        word.text += all[i++];
        continue;
      }
      const std::size_t end = all.find(all[i], i + 1);
      if (end == std::string::npos) {
        word.length = 1;
        word.offset = i;
        Diagnostic d{.code = Code::sdf_quote, .args = {std::string(1, all[i])}};
        point_at(d, word);
        sink.report(std::move(d));
        return std::nullopt;
      }
      word.text.append(all, i + 1, end - i - 1);
      i = end + 1;
    }
    word.length = i - word.offset;
    words.push_back(std::move(word));
  }
  return words;
}

void point_at(Diagnostic& diagnostic, const Word& word, std::size_t offset, std::size_t length) {
  if (!word.source) return;  // not read, but made
  std::size_t begin = word.offset, count = word.length;
  const std::string_view text = word.source->text;
  const bool whole_in_quotes = word.length == word.text.size() + 2 && (text[begin] == '\'' || text[begin] == '"');
  if (offset <= word.text.size() && (whole_in_quotes || word.length == word.text.size()) &&
      length != std::string_view::npos) {
    begin += offset + (whole_in_quotes ? 1 : 0);
    count = std::min(length, word.text.size() - offset);
  }
  const std::string_view before = text.substr(0, begin);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  diagnostic.where = {.file = word.source->name,
                      .offset = begin,
                      .length = count,
                      .line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
                      .column = 1 + code_points(before.substr(line_start))};
  // On a command line words have numbers, not lines.
  if (word.source->name.empty()) diagnostic.where.line = diagnostic.where.column = 0;
  diagnostic.related.push_back({.where = {}, .note = excerpt(text, begin, count)});
}

}  // namespace meso::sdf
