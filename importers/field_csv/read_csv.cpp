// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_csv/read_csv.hpp"

#include <algorithm>
#include <charconv>

#include "meso/fields/number_block.hpp"

namespace meso {
namespace {

constexpr std::size_t longest_quote = 40;  // bytes of the file in a message

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\"");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "stress [MPa]": a name and a unit.
fields::Column heading(std::string_view cell) {
  const std::size_t open = cell.find_first_of("[(");
  if (open == std::string_view::npos || open == 0 || (cell.back() != ']' && cell.back() != ')'))
    return {fields::column_name(cell), {}};
  return {fields::column_name(trimmed(cell.substr(0, open))),
          std::string(trimmed(cell.substr(open + 1, cell.size() - open - 2)))};
}

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& file, const RunOptions& run, DiagnosticSink& sink)
      : text_(text), file_(file), run_(run), sink_(sink) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  std::optional<fields::Table> read() {
    fields::Table table;
    std::optional<fields::NumberBlock> values;
    std::string_view line;
    std::size_t columns = 0, rows = 0, line_of_first_record = 0;
    while (next_line(line)) {
      if (columns == 0) {
        find_separator(line);
        if (is_heading(line)) {
          for (std::size_t at = 0; at <= line.size();) table.columns.push_back(heading(next_cell(line, at)));
          columns = table.columns.size();
          continue;
        }
      }
      if (!goes_on()) return std::nullopt;
      if (!values) {
        if (columns == 0) columns = cells_of(line);
        line_of_first_record = line_;
        values = room_for(columns);
        if (!values) return std::nullopt;
      }
      double* const row = values->data() + rows * columns;
      std::size_t found = 0;
      for (std::size_t at = 0; at <= line.size(); ++found) {
        const std::size_t begin = at;
        const std::string_view cell = next_cell(line, at);
        const auto value = number(cell);
        if (!value || found == columns) {
          fault(line, begin, found == columns ? "the end of the line" : "a number", cell);
          return std::nullopt;
        }
        row[found] = *value;
      }
      if (found < columns) {
        fault(line, line.size(), std::to_string(columns) + " cells", std::to_string(found));
        return std::nullopt;
      }
      ++rows;
    }
    if (rows == 0) {
      sink_.report({.code = Code::field_file_empty, .where = {.file = file_}, .args = {"records"}});
      return std::nullopt;
    }
    // legal, and easily wrong: nothing says which number is which.
    if (table.columns.empty())
      sink_.report({.code = Code::field_no_heading,
                    .where = {.file = file_, .length = 1, .line = line_of_first_record, .column = 1},
                    .args = {std::to_string(columns)}});
    table.records = std::move(*values).records(rows, columns);
    return table;
  }

 private:
  /// For what the rest of the file can hold at most: its lines, or a number in every letter.
  std::optional<fields::NumberBlock> room_for(std::size_t columns) {
    const std::string_view left = text_.substr(std::min(at_, text_.size()));
    const auto lines = static_cast<std::size_t>(std::count(left.begin(), left.end(), '\n')) + 2;
    return fields::NumberBlock::make(std::min(columns * lines, text_.size()), run_, sink_);
  }
  std::size_t cells_of(std::string_view line) const {
    std::size_t cells = 0;
    for (std::size_t at = 0; at <= line.size(); ++cells) (void)next_cell(line, at);
    return cells;
  }
  bool goes_on() {
    constexpr std::size_t poll_mask = 0x3FFF;
    if ((line_ & poll_mask) != 0 || !run_.should_stop()) return true;
    sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
    return false;
  }
  bool next_line(std::string_view& line) {
    while (at_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      line = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++line_;
      if (!trimmed(line).empty() && !line.starts_with('#')) return true;
    }
    return false;
  }
  void find_separator(std::string_view line) {
    const std::size_t at = line.find_first_of(",;\t");
    if (at != std::string_view::npos) separator_ = line[at];
  }
  /// Moves `at` behind the cell and its separator; beyond the line's end after the last cell.
  std::string_view next_cell(std::string_view line, std::size_t& at) const {
    const std::size_t end = std::min(line.find(separator_, at), line.size());
    const std::string_view cell = trimmed(line.substr(at, end - at));
    at = end + 1;
    return cell;
  }
  bool is_heading(std::string_view line) const {
    for (std::size_t at = 0; at <= line.size();) {
      if (!number(next_cell(line, at))) return true;
    }
    return false;
  }
  void fault(std::string_view line, std::size_t column, std::string expected, std::string_view found) {
    sink_.report({.code = Code::field_file_syntax,
                  .where = {.file = file_,
                            .offset = static_cast<std::size_t>(line.data() - text_.data()) + column,
                            .length = 1,
                            .line = line_,
                            .column = column + 1},
                  .args = {std::move(expected), std::string(found.substr(0, longest_quote))}});
  }

  std::string_view text_;
  const std::string& file_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  std::size_t at_ = 0, line_ = 0;
  char separator_ = ',';
};

}  // namespace

std::optional<fields::Table> read_field_csv(std::string_view text, const std::string& file, const RunOptions& run,
                                            DiagnosticSink& sink) {
  return CsvReader(text, file, run, sink).read();
}

}  // namespace meso
