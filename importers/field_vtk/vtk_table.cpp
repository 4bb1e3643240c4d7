// SPDX-License-Identifier: Apache-2.0
#include "vtk_table.hpp"

#include <algorithm>
#include <functional>
#include <span>

#include "meso/fields/split_cells.hpp"

namespace meso::vtk {
namespace {

/// VTK's numbers of cells, of first and of higher order, by what their corners make.
enum class Shape { flat, tetra, voxel, cell, other };
struct KnownCell {
  std::int64_t type;
  Shape shape;
  fields::CellKind kind = fields::CellKind::hexahedron;
};
constexpr std::int64_t last_flat = 9;  // vertices, lines, triangles, polygons, quadrilaterals
constexpr KnownCell known_cells[] = {
    {10, Shape::tetra},
    {24, Shape::tetra},
    {11, Shape::voxel},
    {12, Shape::cell},
    {25, Shape::cell},
    {29, Shape::cell},
    {33, Shape::cell},
    {13, Shape::cell, fields::CellKind::wedge},
    {26, Shape::cell, fields::CellKind::wedge},
    {31, Shape::cell, fields::CellKind::wedge},
    {32, Shape::cell, fields::CellKind::wedge},
    {14, Shape::cell, fields::CellKind::pyramid},
    {27, Shape::cell, fields::CellKind::pyramid},
    {37, Shape::cell, fields::CellKind::pyramid},
};
constexpr std::int64_t flat_of_higher_order[] = {21, 22, 23, 28, 30, 34, 35, 36};

KnownCell known_cell(std::int64_t type) {
  for (const KnownCell& known : known_cells) {
    if (known.type == type) return known;
  }
  const bool is_flat = type <= last_flat || std::find(std::begin(flat_of_higher_order), std::end(flat_of_higher_order),
                                                      type) != std::end(flat_of_higher_order);
  return {type, is_flat ? Shape::flat : Shape::other};
}

std::string suffix(std::size_t width, std::size_t i) {
  static constexpr const char* six[] = {"_xx", "_yy", "_zz", "_xy", "_yz", "_xz"};
  constexpr const char* letters = "xyz";
  if (width == 1) return {};
  if (width == 3) return {'_', letters[i]};
  if (width == 6) return six[i];
  if (width == 9) return {'_', letters[i / 3], letters[i % 3]};
  return "_" + std::to_string(i + 1);
}

void report_left_out(bool has_cell_values, std::size_t cells, fields::FileCursor& in) {
  std::string what = has_cell_values ? "values of cells" : "";
  if (cells > 0)
    what += (what.empty() ? "" : ", and ") + std::to_string(cells) +
            (cells == 1 ? " cell of another kind" : " cells of other kinds");
  if (!what.empty()) in.left_out(std::move(what));
}

bool add_cells(const Content& content, fields::Table& table, fields::FileCursor& in) {
  const auto points = static_cast<std::int64_t>(content.places.size() / 3);
  std::size_t others = 0;
  for (std::size_t c = 0; c < content.types.size(); ++c) {
    const KnownCell cell = known_cell(content.types[c]);
    if (cell.shape == Shape::other) ++others;
    if (cell.shape == Shape::flat || cell.shape == Shape::other) continue;
    const std::size_t corners = cell.shape == Shape::tetra ? 4 : corners_of(cell.kind);
    const std::int64_t first = content.offsets[c], end = content.offsets[c + 1];
    if (first < 0 || end > static_cast<std::int64_t>(content.connectivity.size()) || end < first ||
        end - first < static_cast<std::int64_t>(corners))
      return in.expected("cells with enough points");
    std::array<std::int64_t, 8> point{};
    for (std::size_t i = 0; i < corners; ++i) {
      point[i] = content.connectivity[static_cast<std::size_t>(first) + i];
      if (point[i] < 0 || point[i] >= points) return in.expected("cells of points that exist");
    }
    if (cell.shape == Shape::voxel) {  // its corners run along x, y and z
      std::swap(point[2], point[3]);
      std::swap(point[6], point[7]);
    }
    if (cell.kind != fields::CellKind::hexahedron) {
      append_tetrahedra(cell.kind, std::span(point).first(corners), table.tetra);
    } else {
      auto& list = corners == 4 ? table.tetra : table.hexa;
      list.insert(list.end(), point.begin(), point.begin() + static_cast<std::ptrdiff_t>(corners));
    }
  }
  report_left_out(content.has_cell_values, others, in);
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
