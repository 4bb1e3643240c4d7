// SPDX-License-Identifier: Apache-2.0
#include "vtk_table.hpp"

#include <algorithm>
#include <functional>

namespace meso::vtk {
namespace {

constexpr std::int64_t tetra = 10, hexa = 12, quadratic_tetra = 24, quadratic_hexa = 25, triquadratic_hexa = 29;

std::string suffix(std::size_t width, std::size_t i) {
  static constexpr const char* six[] = {"_xx", "_yy", "_zz", "_xy", "_yz", "_xz"};
  constexpr const char* letters = "xyz";
  if (width == 1) return {};
  if (width == 3) return {'_', letters[i]};
  if (width == 6) return six[i];
  if (width == 9) return {'_', letters[i / 3], letters[i % 3]};
  return "_" + std::to_string(i + 1);
}

bool add_cells(const Content& content, fields::Table& table, fields::FileCursor& in) {
  const auto points = static_cast<std::int64_t>(content.places.size() / 3);
  for (std::size_t c = 0; c < content.types.size(); ++c) {
    const std::int64_t type = content.types[c];
    const bool is_tetra = type == tetra || type == quadratic_tetra;
    if (!is_tetra && type != hexa && type != quadratic_hexa && type != triquadratic_hexa) continue;
    const std::size_t corners = is_tetra ? 4 : 8;
    const std::int64_t first = content.offsets[c], end = content.offsets[c + 1];
    if (first < 0 || end > static_cast<std::int64_t>(content.connectivity.size()) || end < first ||
        end - first < static_cast<std::int64_t>(corners))
      return in.expected("cells with enough points");
    for (std::size_t i = 0; i < corners; ++i) {
      const std::int64_t point = content.connectivity[static_cast<std::size_t>(first) + i];
      if (point < 0 || point >= points) return in.expected("cells of points that exist");
      (is_tetra ? table.tetra : table.hexa).push_back(point);
    }
  }
  return true;
}

}  // namespace

std::optional<fields::Table> make_table(Content content, const std::string& wanted, fields::FileCursor& in) {
  const std::size_t rows = content.places.size() / 3;
  if (rows == 0) {
    in.empty("points");
    return std::nullopt;
  }
  for (const std::vector<double>& nodes : content.grid) {
    if (std::all_of(nodes.begin(), nodes.end(), [](double v) { return std::isfinite(v); }) &&
        std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) == nodes.end())
      continue;
    in.unsupported("a grid whose coordinates do not ascend");
    return std::nullopt;
  }
  std::erase_if(content.arrays, [&](const Array& a) { return !wanted.empty() && a.name != wanted; });
  if (!wanted.empty() && content.arrays.empty()) {
    in.empty("array '" + wanted + "'");
    return std::nullopt;
  }
  fields::Table table;
  for (const char* name : {"x", "y", "z"}) table.columns.push_back({name, {}});
  for (const Array& array : content.arrays) {
    // Not as a product: widths of any size may be stated.
    if (array.values.size() % rows != 0 || array.values.size() / rows != array.width) {
      in.expected(std::to_string(array.width) + " numbers for each point in the array '" + array.name + "'");
      return std::nullopt;
    }
    for (std::size_t i = 0; i < array.width; ++i)
      table.columns.push_back({fields::column_name(array.name) + suffix(array.width, i), {}});
  }
  std::vector<double> values;
  values.reserve(rows * table.columns.size());
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t i = 0; i < 3; ++i) values.push_back(content.places[3 * r + i]);
    for (const Array& array : content.arrays) {
      for (std::size_t i = 0; i < array.width; ++i) values.push_back(array.values[r * array.width + i]);
    }
  }
  table.records = fields::Records::of(std::move(values), table.columns.size());
  table.grid = std::move(content.grid);
  table.is_regular = content.is_regular;
  if (!add_cells(content, table, in)) return std::nullopt;
  return table;
}

}  // namespace meso::vtk
