// SPDX-License-Identifier: Apache-2.0
#include "field_document.hpp"

#include <algorithm>
#include <set>
#include <span>

#include "meso/base/number.hpp"
#include "meso/fields/base64.hpp"
#include "meso/fields/split_cells.hpp"

namespace meso::operations {
namespace {

constexpr std::string_view orders[] = {"xx", "yy", "zz", "xy", "yz", "zx"};

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return text;
}

/// Columns whose names are one stem with each of the endings.
std::vector<std::size_t> family(const fields::Table& table, const std::vector<std::string>& endings) {
  for (const fields::Column& first : table.columns) {
    const std::string name = lower(first.name);
    if (!name.ends_with(endings[0])) continue;
    const std::string stem = name.substr(0, name.size() - endings[0].size());
    if (stem.empty()) continue;
    std::vector<std::size_t> found;
    for (const std::string& ending : endings) {
      const auto column = std::find_if(table.columns.begin(), table.columns.end(),
                                       [&](const fields::Column& c) { return lower(c.name) == stem + ending; });
      if (column != table.columns.end()) found.push_back(static_cast<std::size_t>(column - table.columns.begin()));
    }
    if (found.size() == endings.size()) return found;
  }
  return {};
}

/// Elements of one kind, as a field has them: where there are both, a hexahedron becomes six tetrahedra.
std::vector<std::int64_t> tetrahedra_of(const fields::Table& table) {
  std::vector<std::int64_t> result = table.tetra;
  for (std::size_t first = 0; first < table.hexa.size(); first += 8)
    append_tetrahedra(fields::CellKind::hexahedron, std::span(table.hexa).subspan(first, 8), result);
  return result;
}

std::string base64_of(const std::vector<double>& values) {
  return fields::encode_base64(reinterpret_cast<const std::byte*>(values.data()), values.size() * sizeof(double));
}

class FieldWriter {
 public:
  FieldWriter(const fields::Table& table, const std::string& unit) : table_(table), unit_(unit) {
    for (const char* last : {"zx", "xz"}) {
      if (tensor_.empty()) tensor_ = family(table, {"xx", "yy", "zz", "xy", "yz", last});
    }
    for (const auto& endings : {std::vector<std::string>{"_x", "_y", "_z"}, {"1", "2", "3"}}) {
      if (vector_.empty()) vector_ = family(table, endings);
    }
    is_grid_ = !table.grid[0].empty();
  }

  VectorField field(const std::string& id) {
    VectorField field;
    field.id = Id{id};
    FieldStructure structure;
    structure.records = static_cast<std::int64_t>(table_.records.rows());
    for (std::size_t c = 0; c < table_.columns.size(); ++c) add(c, structure);
    if (is_grid_)
      structure.location = table_.is_regular ? FieldLocation(regular()) : FieldLocation(rectilinear());
    else if (!table_.tetra.empty() || !table_.hexa.empty())
      structure.location = mesh();
    else
      structure.location = PointsLocation{};
    field.structure = std::move(structure);
    std::vector<double> values;
    values.reserve(table_.records.rows() * taken_.size());
    for (std::size_t r = 0; r < table_.records.rows(); ++r) {
      for (const std::size_t c : taken_) values.push_back(table_.records(r, c));
    }
    EmbeddedValues embedded;
    embedded.base64 = base64_of(values);
    field.values = std::move(embedded);
    Interpolation interpolation;
    interpolation.method = std::holds_alternative<PointsLocation>(field.structure->location)
                               ? InterpolationMethod::nearest
                               : InterpolationMethod::linear;
    field.interpolation = interpolation;
    return field;
  }

 private:
  void add(std::size_t c, FieldStructure& structure) {
    const fields::Column& column = table_.columns[c];
    const bool is_position = column.name == "x" || column.name == "y" || column.name == "z";
    if (is_position && is_grid_) return;
    FieldComponent component;
    component.name = Name{column.name};
    if (!column.unit.empty()) component.unit = column.unit;
    const auto in_tensor = std::find(tensor_.begin(), tensor_.end(), c);
    if (is_position) {
      component.role = ComponentRole::position;
      component.unit = column.unit.empty() ? unit_ : column.unit;
    } else if (in_tensor != tensor_.end()) {
      component.role = ComponentRole::tensor;
      component.order = std::string(orders[in_tensor - tensor_.begin()]);
    } else if (std::find(vector_.begin(), vector_.end(), c) != vector_.end()) {
      component.role = ComponentRole::vector;
    }
    structure.components.push_back(std::move(component));
    taken_.push_back(c);
  }
  // Rows run x fastest: z is the outermost axis.
  RegularGridLocation regular() const {
    RegularGridLocation grid;
    for (std::size_t a = 3; a-- > 0;) {
      const std::vector<double>& nodes = table_.grid[a];
      GridAxis axis;
      axis.name = Name{std::string(1, "xyz"[a])};
      axis.start = Expression{format_number(nodes[0]) + unit_};
      axis.spacing = Expression{format_number(nodes.size() > 1 ? nodes[1] - nodes[0] : 1) + unit_};
      axis.count = static_cast<std::int64_t>(nodes.size());
      grid.axes.push_back(std::move(axis));
    }
    return grid;
  }
  RectilinearGridLocation rectilinear() const {
    RectilinearGridLocation grid;
    for (std::size_t a = 3; a-- > 0;) {
      RectilinearAxis axis;
      axis.name = Name{std::string(1, "xyz"[a])};
      for (const double node : table_.grid[a])
        axis.at.text += (axis.at.text.empty() ? "" : ", ") + format_number(node) + unit_;
      grid.axes.push_back(std::move(axis));
    }
    return grid;
  }
  MeshLocation mesh() const {
    MeshLocation location;
    const bool is_tetra = !table_.tetra.empty();
    const std::vector<std::int64_t> cells = is_tetra ? tetrahedra_of(table_) : table_.hexa;
    location.type = is_tetra ? MeshElementType::tetra : MeshElementType::hexa;
    location.elements = static_cast<std::int64_t>(cells.size() / (is_tetra ? 4 : 8));
    EmbeddedValues embedded;
    embedded.base64 =
        fields::encode_base64(reinterpret_cast<const std::byte*>(cells.data()), cells.size() * sizeof(std::int64_t));
    location.connectivity = std::move(embedded);
    return location;
  }

  const fields::Table& table_;
  const std::string& unit_;
  std::vector<std::size_t> tensor_, vector_, taken_;
  bool is_grid_ = false;
};

}  // namespace

Document field_document(const fields::Table& table, const std::string& id, const std::string& unit) {
  Document document;
  document.version = "1.0";
  document.unit = LengthUnit::millimeter;
  document.vector_fields.items.push_back(FieldWriter(table, unit).field(id));
  return document;
}

}  // namespace meso::operations
