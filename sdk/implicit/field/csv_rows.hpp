// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rows of the room's tables, column by name. Part of tests.

#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace meso::implicit {

using Row = std::map<std::string, std::string>;

/// Commas separate, quotes keep commas, lines that begin with # are comments, the first line names the columns.
inline std::vector<Row> csv_rows(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> columns;
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    if (columns.empty()) {
      columns = cells;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = cells.at(i);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace meso::implicit
