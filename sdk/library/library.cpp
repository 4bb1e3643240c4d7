// SPDX-License-Identifier: Apache-2.0
#include "meso/library/library.hpp"

#include <algorithm>
#include <cassert>
#include <string>

#include "meso/xml/read.hpp"
#include "texts.hpp"

namespace meso {
namespace {

std::vector<UnitCell> read_library() {
  std::vector<UnitCell> cells;
  for (const LibraryText& cell : library_texts) {
    DiagnosticSink sink;
    auto read = read_document(std::string(cell.text), std::string(cell.name), sink);
    assert(read && read->document.unit_cells.size() == 1);
    cells.push_back(std::move(read->document.unit_cells.items.front()));
  }
  return cells;
}

}  // namespace

const UnitCell* find_library_cell(std::string_view name) {
  static const std::vector<UnitCell> cells = read_library();
  const auto found =
      std::ranges::find(cells, name, [](const UnitCell& cell) -> std::string_view { return cell.id.text; });
  return found == cells.end() ? nullptr : &*found;
}

std::vector<std::string_view> library_cell_names() {
  std::vector<std::string_view> names;
  for (const LibraryText& cell : library_texts) names.push_back(cell.name);
  return names;
}

}  // namespace meso
