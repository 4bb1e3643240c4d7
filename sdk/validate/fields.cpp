// SPDX-License-Identifier: Apache-2.0
// the structure of vector fields, and whether the values fit it.
#include <algorithm>
#include <limits>
#include <set>

#include "families.hpp"
#include "meso/model/field_quantities.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

constexpr std::int64_t too_many = std::numeric_limits<std::int64_t>::max();

/// a * b for numbers >= 0; too_many if that does not fit.
std::int64_t product(std::int64_t a, std::int64_t b) {
  std::int64_t result = 0;
  return __builtin_mul_overflow(a, b, &result) ? too_many : result;
}

void check_count(Context& c, const Element& element, std::string_view attribute, std::int64_t count) {
  if (count < 1)
    c.report(Code::value_not_whole, element, attribute, {std::string(attribute), "1", std::to_string(count)});
}

void check_components(Context& c, const FieldStructure& structure) {
  if (structure.components.empty())
    c.report(Code::content_needed, structure, "", {"structure", "at least one <component>", "none"});
  Scope names;
  std::set<std::string_view> orders;
  static constexpr std::array<std::string_view, 6> known{"xx", "yy", "zz", "xy", "yz", "zx"};
  for (const FieldComponent& component : structure.components) {
    if (c.check_name(component, "name", component.name.text))
      c.declare(names, component, "name", component.name.text, "a component");
    const bool is_tensor = component.role == ComponentRole::tensor;
    const std::string order = component.order.value_or("none");
    const bool good = is_tensor ? std::find(known.begin(), known.end(), order) != known.end() &&
                                      orders.insert(*component.order).second
                                : !component.order.has_value();
    if (!good) c.report(Code::field_tensor_order, component, "order", {order});
  }
}

/// Axes of a grid: all names known and different; the product of the counts.
class GridCheck {
 public:
  GridCheck(Context& c, const std::optional<Ref<CoordinateSystem>>& system)
      : c_(c), system_(system), axes_(axes_of(c, system)) {}

  void axis(const Element& element, const Name& name) {
    if (axes_ == nullptr) return;
    const auto position = find_axis(c_, *axes_, system_ ? system_->text : "", element, "name", name);
    if (position && !used_.insert(*position).second) c_.report(Code::axis_twice, element, "name", {name.text});
  }

 private:
  Context& c_;
  const std::optional<Ref<CoordinateSystem>>& system_;
  const std::vector<Axis>* axes_;
  std::set<std::size_t> used_;
};

std::int64_t check_grid(Context& c, const RegularGridLocation& grid) {
  GridCheck check(c, grid.coordinate_system);
  std::int64_t points = 1;
  for (const GridAxis& axis : grid.axes) {
    check.axis(axis, axis.name);
    check_count(c, axis, "count", axis.count);
    (void)c.check(axis, "start", axis.start, c.parameters);
    if (c.check(axis, "spacing", axis.spacing, c.parameters)) c.require_positive(axis, "spacing", axis.spacing);
    points = product(points, std::max<std::int64_t>(axis.count, 0));
  }
  return points;
}

std::int64_t check_grid(Context& c, const RectilinearGridLocation& grid) {
  GridCheck check(c, grid.coordinate_system);
  std::int64_t points = 1;
  for (const RectilinearAxis& axis : grid.axes) {
    check.axis(axis, axis.name);
    const auto at = c.check(axis, "at", axis.at, c.parameters) ? c.constants(axis.at) : std::nullopt;
    if (at && std::adjacent_find(at->begin(), at->end(), [](double a, double b) { return !(a < b); }) != at->end())
      c.report(Code::field_not_ascending, axis, "at", {axis.name.text});
    points = product(points, static_cast<std::int64_t>(split_count(axis.at)));
  }
  return points;
}

template <class Grid>
void check_grid_records(Context& c, const FieldStructure& structure, const Grid& grid) {
  if (grid.axes.empty()) {
    c.report(Code::content_needed, grid, "", {std::string(element_name<Grid>), "at least one <axis>", "none"});
    return;
  }
  const std::int64_t points = check_grid(c, grid);
  if (points > 0 && points != structure.records)
    c.report(Code::field_grid_records, structure, "records",
             {points == too_many ? "too many" : std::to_string(points), std::to_string(structure.records)});
}

void check_positions(Context& c, const FieldStructure& structure, std::size_t needed) {
  const auto found = static_cast<std::size_t>(
      std::count_if(structure.components.begin(), structure.components.end(),
                    [](const FieldComponent& component) { return component.role == ComponentRole::position; }));
  if (found != needed) c.report(Code::field_position, structure, "", {std::to_string(needed), std::to_string(found)});
}

/// Bytes that base64 text stands for, white space aside; nothing if it is not base64.
std::optional<std::int64_t> decoded_bytes(std::string_view text) {
  std::int64_t digits = 0, padding = 0;
  for (const char letter : text) {
    if (letter == ' ' || letter == '\n' || letter == '\t' || letter == '\r') continue;
    const bool is_digit = (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z') ||
                          (letter >= '0' && letter <= '9') || letter == '+' || letter == '/';
    if (letter == '=')
      ++padding;
    else if (is_digit && padding == 0)
      ++digits;
    else
      return std::nullopt;
  }
  if ((digits + padding) % 4 != 0 || padding > 2) return std::nullopt;
  return (digits + padding) / 4 * 3 - padding;
}

void check_values(Context& c, const FieldValues& values, std::int64_t numbers) {
  if (const auto* embedded = std::get_if<EmbeddedValues>(&values)) {
    const auto bytes = decoded_bytes(embedded->base64);
    const std::int64_t needed = product(numbers, 8);
    if (!bytes)
      c.report(Code::field_base64, *embedded, "", {});
    else if (*bytes != needed)
      c.report(Code::field_values_size, *embedded, "", {std::to_string(*bytes), std::to_string(needed)});
  }
  if (const auto* external = std::get_if<ExternalValues>(&values)) {
    const bool is_raw = external->format == ValueFormat::raw;
    if (!is_raw && external->offset)
      c.report(Code::attribute_ineffective, *external, "offset", {"offset", "outside raw files"});
    if (!is_raw && external->stride)
      c.report(Code::attribute_ineffective, *external, "stride", {"stride", "outside raw files"});
    if (is_raw && external->path) c.report(Code::attribute_ineffective, *external, "path", {"path", "in raw files"});
    if (external->format == ValueFormat::hdf5 && !external->path)
      c.report(Code::attribute_needed, *external, "", {"path", "to find the data set in the file"});
    if (external->offset && *external->offset < 0)
      c.report(Code::value_negative, *external, "offset", {"offset", std::to_string(*external->offset)});
    if (external->stride) check_count(c, *external, "stride", *external->stride);
  }
}

void check_location(Context& c, const FieldStructure& structure) {
  if (std::holds_alternative<std::monostate>(structure.location))
    c.report(Code::content_needed, structure, "", {"structure", "a location", "none"});
  if (const auto* points = std::get_if<PointsLocation>(&structure.location))
    if (const auto* axes = axes_of(c, points->coordinate_system)) check_positions(c, structure, axes->size());
  if (const auto* grid = std::get_if<RegularGridLocation>(&structure.location)) {
    check_positions(c, structure, 0);
    check_grid_records(c, structure, *grid);
  }
  if (const auto* grid = std::get_if<RectilinearGridLocation>(&structure.location)) {
    check_positions(c, structure, 0);
    check_grid_records(c, structure, *grid);
  }
  if (const auto* mesh = std::get_if<MeshLocation>(&structure.location)) {
    check_positions(c, structure, 3);
    check_count(c, *mesh, "elements", mesh->elements);
    if (std::holds_alternative<std::monostate>(mesh->connectivity))
      c.report(Code::content_needed, *mesh, "", {"mesh", "its connectivity", "none"});
    if (mesh->elements > 0)
      check_values(c, mesh->connectivity, product(mesh->elements, mesh->type == MeshElementType::tetra ? 4 : 8));
  }
}

void check_source(Context& c, const VectorField& field) {
  const bool has_values = !std::holds_alternative<std::monostate>(field.values);
  if (field.macrostructure && (field.structure || has_values))
    c.report(Code::field_source, field, "", {"found both"});
  else if (!field.macrostructure && !field.structure)
    c.report(Code::field_source, field, "", {"found no structure"});
  else if (!field.macrostructure && !has_values)
    c.report(Code::field_source, field, "", {"found no values"});
}

void check_interpolation(Context& c, const VectorField& field) {
  if (field.interpolation) {
    const Interpolation& i = *field.interpolation;
    const bool is_points = field.structure && std::holds_alternative<PointsLocation>(field.structure->location);
    if (field.macrostructure)
      c.report(Code::field_interpolation, i, "method", {"a macrostructure", "a method: it is known everywhere"});
    else if (i.method == InterpolationMethod::linear && is_points)
      c.report(Code::field_interpolation, i, "method", {"a cloud of points", "linear"});
    if (i.power && i.method != InterpolationMethod::inverse_distance)
      c.report(Code::attribute_ineffective, i, "power", {"power", "without method=\"inverseDistance\""});
    if (c.check(i, "power", i.power, c.parameters)) c.require_positive(i, "power", i.power);
  }
  if (field.outside) {
    const Outside& o = *field.outside;
    const bool is_value = o.rule == OutsideRule::value;
    if (is_value && !o.value) c.report(Code::attribute_needed, o, "", {"value", "with rule=\"value\""});
    if (!is_value && o.value) c.report(Code::attribute_ineffective, o, "value", {"value", "without rule=\"value\""});
    (void)c.check(o, "value", o.value, c.parameters);
  }
}

}  // namespace

std::vector<std::string> component_names(const VectorField& field) {
  std::vector<std::string> names;
  for (FieldQuantity& quantity : field_quantities(field)) names.push_back(std::move(quantity.name));
  return names;
}

void check_fields(Context& c) {
  for (const VectorField& field : c.document.vector_fields) {
    check_source(c, field);
    check_interpolation(c, field);
    if (!field.structure) continue;
    const FieldStructure& structure = *field.structure;
    check_count(c, structure, "records", structure.records);
    check_components(c, structure);
    check_location(c, structure);
    if (structure.records > 0)
      check_values(c, field.values, product(structure.records, static_cast<std::int64_t>(structure.components.size())));
  }
}

}  // namespace meso
