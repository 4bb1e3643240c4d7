// SPDX-License-Identifier: Apache-2.0
// From <vectorField> to numbers: embedded or from a file, columns matched with components, units, finite.
#include <algorithm>
#include <array>
#include <cmath>

#include "evaluation_impl.hpp"
#include "field_source.hpp"
#include "meso/base/number.hpp"
#include "meso/fields/base64.hpp"
#include "meso/fields/number_block.hpp"
#include "meso/fields/statistics.hpp"
#include "meso/import_field_file/read_field_file.hpp"
#include "meso/resource/resource.hpp"

namespace meso::eval {
namespace {

struct KnownUnit {
  std::string_view text;
  double factor;  ///< to millimetres or radians
  bool is_length;
};
constexpr KnownUnit units[] = {
    {"um", 1e-3, true}, {"mm", 1, true},     {"cm", 10, true},  {"m", 1e3, true},
    {"in", 25.4, true}, {"ft", 304.8, true}, {"rad", 1, false}, {"deg", 3.14159265358979323846 / 180, false}};

const KnownUnit* find_unit(std::string_view text) {
  const auto* found =
      std::find_if(std::begin(units), std::end(units), [&](const KnownUnit& u) { return u.text == text; });
  return found == std::end(units) ? nullptr : found;
}

constexpr std::uint64_t bytes_per_place = 64;  // a place, and the search tree that holds it

bool has_points(ValueFormat format) {
  return format == ValueFormat::vtk || format == ValueFormat::vtu || format == ValueFormat::frd ||
         format == ValueFormat::msh;
}

}  // namespace

class FieldLoader {
 public:
  FieldLoader(const EvaluationData& data, const VectorField& field, const Report& report)
      : data_(data), field_(field), report_(report), source_(std::make_shared<FieldSource>()) {
    source_->field_ = &field;
    source_->millimeters_ = data.millimeters();
  }

  std::shared_ptr<FieldSource> load() {
    if (field_.macrostructure) return wall();
    const auto table = values();
    if (!table || !match(*table) || !units_agree(*table) || !is_finite() || !locate() || !settings()) return nullptr;
    return source_;
  }
  bool prepare(FieldSource& source);

 private:
  const FieldStructure& structure() const { return *field_.structure; }
  const std::vector<FieldComponent>& components() const { return structure().components; }
  Place values_place() const {
    return {std::visit(
                [](const auto& v) {
                  if constexpr (std::is_base_of_v<Element, std::decay_t<decltype(v)>>) return v.id_in_source;
                  return ElementId{};
                },
                field_.values),
            {}};
  }
  bool fault(Code code, const Place& place, std::vector<std::string> args) const {
    report_(code, place, std::move(args));
    return false;
  }

  std::string memory_text() const { return std::to_string(data_.run.max_memory_bytes >> 20) + " MiB"; }

  bool stopped() const {
    report_.sink.report({.code = data_.run.out_of_time() ? Code::limit_time : Code::cancelled});
    return false;
  }
  bool is_stopped(std::size_t done) const {
    constexpr std::size_t poll_mask = 0xFFFF;
    return (done & poll_mask) == 0 && data_.run.should_stop();
  }

  std::shared_ptr<FieldSource> wall() {
    const Macrostructure& macrostructure =
        *std::find_if(data_.document().macrostructures.begin(), data_.document().macrostructures.end(),
                      [&](const Macrostructure& m) { return m.id.text == field_.macrostructure->text; });
    if (!data_.distance) {
      fault(Code::field_not_realised, {field_.id_in_source, "macrostructure"},
            {field_.id.text, "the distance to a macrostructure"});
      return nullptr;
    }
    source_->wall_ = data_.distance(data_.checked, macrostructure, report_.sink);
    return source_->wall_ ? source_ : nullptr;
  }

  std::optional<fields::Table> values() const {
    if (const auto* embedded = std::get_if<EmbeddedValues>(&field_.values)) {
      const std::size_t most = fields::base64_bytes_at_most(embedded->base64.size());
      auto numbers = fields::NumberBlock::make(most / sizeof(double) + 1, data_.run, report_.sink);
      if (!numbers) return std::nullopt;
      const auto size = decode(*embedded, reinterpret_cast<std::byte*>(numbers->data()));
      if (!size) return std::nullopt;
      fields::Table table;
      table.records = std::move(*numbers).records(*size / sizeof(double) / components().size(), components().size());
      return table;
    }
    return read_with<fields::Table>(std::get<ExternalValues>(field_.values), read_field_file, components().size());
  }

  // Validation has counted the bytes.
  std::optional<std::size_t> decode(const EmbeddedValues& embedded, std::byte* out) const {
    const auto size = fields::decode_base64(embedded.base64, out);
    if (!size) report_(Code::field_base64, {embedded.id_in_source, {}}, {});
    return size;
  }

  /// Faults of the file keep their place in it and say which element asked for it.
  template <class T, class Read>
  std::optional<T> read_with(const ExternalValues& external, const Read& read, std::size_t columns,
                             std::size_t rows = 0) const {
    const Place place{external.id_in_source, "href"};
    const auto file = data_.checked.resources().find(external.href.text);
    if (!file) {
      report_(Code::import_unreadable, place, {external.href.text, "it is outside of the document's folder"});
      return std::nullopt;
    }
    if (external.sha256) {
      const auto sum = sha256_of(*file);
      if (sum && *sum != *external.sha256) {
        report_(Code::import_changed, {external.id_in_source, "sha256"}, {external.href.text, *sum, *external.sha256});
        return std::nullopt;
      }
    }
    DiagnosticSink faults;
    auto result = read({.file = *file,
                        .format = external.format,
                        .path = external.path.value_or(""),
                        .offset = static_cast<std::uint64_t>(external.offset.value_or(0)),
                        .stride = static_cast<std::uint64_t>(external.stride.value_or(0)),
                        .rows = rows == 0 ? static_cast<std::size_t>(structure().records) : rows,
                        .columns = columns,
                        .run = data_.run},
                       faults);
    for (Diagnostic d : faults.diagnostics()) {
      const SourceSpan asked = report_.source.span(external.id_in_source, "href");
      if (d.where.file.empty()) {
        d.where = asked;
        d.path = report_.source.path(external.id_in_source, "href");
      } else {
        d.related.push_back({asked, "which holds the values of the field '" + field_.id.text + "'"});
      }
      report_.sink.report(std::move(d));
    }
    return result;
  }

  /// by name where the file has names, else in order.
  bool match(const fields::Table& table) {
    const auto* external = std::get_if<ExternalValues>(&field_.values);
    source_->records_ = table.records;
    const std::size_t found = table.records.columns();
    if (table.columns.empty() && found != components().size())
      return fault(Code::field_column_count, values_place(),
                   {field_.id.text, std::to_string(found), std::to_string(components().size())});
    if (static_cast<std::int64_t>(table.records.rows()) != structure().records)
      return fault(Code::field_record_count, {structure().id_in_source, "records"},
                   {field_.id.text, std::to_string(table.records.rows()), std::to_string(structure().records)});
    const bool is_one_array = external != nullptr && has_points(external->format) && external->path;
    std::size_t positions = 0, others = 0;
    for (std::size_t c = 0; c < components().size(); ++c) {
      const FieldComponent& component = components()[c];
      const bool is_position = component.role == ComponentRole::position;
      std::optional<std::size_t> column;
      if (table.columns.empty())
        column = c;
      else if (is_position && external != nullptr && has_points(external->format))
        column = positions < 3 ? find(table, std::string(1, "xyz"[positions])) : std::nullopt;
      else if (is_one_array)
        column = others + 3 < found ? std::optional(others + 3) : std::nullopt;
      else
        column = find(table, component.name.text);
      ++(is_position ? positions : others);
      if (!column) return unknown_column(table, component);
      source_->columns_.push_back({*column, 1});
    }
    if (is_one_array && others + 3 != found)
      return fault(Code::field_column_count, values_place(),
                   {field_.id.text, std::to_string(found - 3), std::to_string(others)});
    return true;
  }
  static std::optional<std::size_t> find(const fields::Table& table, const std::string& name) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (table.columns[c].name == name) return c;
    }
    return std::nullopt;
  }
  bool unknown_column(const fields::Table& table, const FieldComponent& component) const {
    std::vector<std::string_view> names;
    for (const fields::Column& c : table.columns) names.push_back(c.name);
    return fault(Code::field_column, {component.id_in_source, "name"},
                 {field_.id.text, component.name.text, suggestion(component.name.text, names)});
  }

  /// lengths and angles become the document's; a vector and a tensor have one unit.
  bool units_agree(const fields::Table& table) {
    std::optional<std::string> of_vector, of_tensor;
    std::size_t position = 0;
    for (std::size_t c = 0; c < components().size(); ++c) {
      const FieldComponent& component = components()[c];
      const Place place{component.id_in_source, "unit"};
      const std::string stated = component.unit.value_or("");
      const std::string in_file = table.columns.empty() ? "" : table.columns[source_->columns_[c].column].unit;
      if (component.unit && !in_file.empty() && in_file != stated)
        return fault(Code::field_unit, place, {component.name.text, stated, "the file says '" + in_file + "'"});
      const KnownUnit* unit = find_unit(stated);
      if (unit != nullptr) source_->columns_[c].factor = unit->factor / (unit->is_length ? data_.millimeters() : 1);
      if (component.role == ComponentRole::position && !position_unit(component, unit, in_file, position++))
        return false;
      auto& whole = component.role == ComponentRole::vector ? of_vector : of_tensor;
      if (component.role != ComponentRole::vector && component.role != ComponentRole::tensor) continue;
      if (whole && *whole != stated)
        return fault(Code::field_unit, place,
                     {component.name.text, stated, "components before it have '" + *whole + "'"});
      whole = stated;
    }
    return true;
  }
  bool position_unit(const FieldComponent& component, const KnownUnit* unit, const std::string& in_file,
                     std::size_t position) const {
    const AxisKind kind = system()->axes()[position].kind;
    const bool needs_length = kind != AxisKind::circular;
    const auto is_needed = [&](const KnownUnit& u) { return u.is_length == needs_length; };
    if (!component.unit) {
      const KnownUnit* found = find_unit(in_file);
      if (found == nullptr || (is_needed(*found) && found->factor == (needs_length ? data_.millimeters() : 1)))
        return true;
      return fault(Code::field_unit, {component.id_in_source, {}},
                   {component.name.text, in_file, "only the file says so, state it here"});
    }
    if (kind == AxisKind::scalar || (unit != nullptr && is_needed(*unit))) return true;
    return fault(Code::field_unit, {component.id_in_source, "unit"},
                 {component.name.text, *component.unit, needs_length ? "a length is needed" : "an angle is needed"});
  }

  bool is_finite() const {
    const auto all = fields::statistics(source_->records_, data_.run);
    if (!all) return stopped();
    for (std::size_t c = 0; c < components().size(); ++c) {
      const fields::ColumnStatistics& s = (*all)[source_->columns_[c].column];
      if (s.nan + s.infinite > 0)
        return fault(Code::field_not_finite, values_place(),
                     {field_.id.text, components()[c].name.text, std::to_string(s.nan + s.infinite),
                      std::to_string(source_->records()), std::to_string(s.first_not_finite)});
    }
    return true;
  }

  std::shared_ptr<const CoordinateFrame> system() const {
    const auto named = std::visit(
        [](const auto& location) -> std::optional<Ref<CoordinateSystem>> {
          if constexpr (requires { location.coordinate_system; }) return location.coordinate_system;
          return std::nullopt;
        },
        structure().location);
    return named ? data_.frames.find(named->text)->second : data_.cartesian;
  }

  bool locate() {
    source_->system_ = system();
    for (std::size_t c = 0; c < components().size(); ++c) {
      static constexpr std::array<std::string_view, 6> orders{"xx", "yy", "zz", "xy", "yz", "zx"};
      const FieldComponent& component = components()[c];
      if (component.role == ComponentRole::position) source_->position_.push_back(c);
      if (component.role == ComponentRole::tensor)
        source_->tensor_[static_cast<std::size_t>(std::find(orders.begin(), orders.end(), *component.order) -
                                                  orders.begin())] = c;
    }
    std::vector<std::vector<double>> axes;
    if (const auto* grid = std::get_if<RegularGridLocation>(&structure().location)) {
      for (const GridAxis& axis : grid->axes) {
        const auto start = data_.value(axis.start, {axis.id_in_source, "start"}, report_),
                   spacing = data_.value(axis.spacing, {axis.id_in_source, "spacing"}, report_);
        if (!start || !spacing) return false;
        if (!(*spacing > 0))
          return fault(Code::value_not_positive, {axis.id_in_source, "spacing"}, {"spacing", format_number(*spacing)});
        auto& nodes = axes.emplace_back();
        for (std::int64_t i = 0; i < axis.count; ++i) nodes.push_back(*start + static_cast<double>(i) * *spacing);
        add_grid_axis(axis.name);
      }
    }
    if (const auto* grid = std::get_if<RectilinearGridLocation>(&structure().location)) {
      for (const RectilinearAxis& axis : grid->axes) {
        auto nodes = data_.values(axis.at, {axis.id_in_source, "at"}, expr::split_list(axis.at.text).size(), report_);
        if (!nodes) return false;
        if (std::adjacent_find(nodes->begin(), nodes->end(), std::greater_equal<>()) != nodes->end())
          return fault(Code::field_not_ascending, {axis.id_in_source, "at"}, {axis.name.text});
        axes.push_back(std::move(*nodes));
        add_grid_axis(axis.name);
      }
    }
    if (axes.size() > fields::most_grid_axes)
      return fault(Code::field_not_realised, {structure().id_in_source, {}},
                   {field_.id.text, "a grid of more than three axes"});
    if (!axes.empty()) source_->grid_.emplace(std::move(axes));
    return true;
  }
  void add_grid_axis(const Name& name) {
    const auto& axes = source_->system_->axes();
    source_->grid_axes_.push_back(static_cast<std::size_t>(
        std::find_if(axes.begin(), axes.end(), [&](const CoordinateAxis& a) { return a.name == name.text; }) -
        axes.begin()));
  }

  bool settings() {
    if (field_.interpolation && field_.interpolation->power) {
      const auto power =
          data_.value(*field_.interpolation->power, {field_.interpolation->id_in_source, "power"}, report_);
      if (!power) return false;
      if (!(*power > 0))
        return fault(Code::value_not_positive, {field_.interpolation->id_in_source, "power"},
                     {"power", format_number(*power)});
      source_->power_ = *power;
    }
    if (field_.outside && field_.outside->value) {
      source_->outside_value_ = data_.value(*field_.outside->value, {field_.outside->id_in_source, "value"}, report_);
      if (!source_->outside_value_) return false;
    }
    return true;
  }

  std::optional<std::vector<std::int64_t>> connectivity(const MeshLocation& mesh, std::size_t corners) const {
    if (const auto* embedded = std::get_if<EmbeddedValues>(&mesh.connectivity)) {
      const std::size_t most = fields::base64_bytes_at_most(embedded->base64.size());
      if (most > data_.run.max_memory_bytes) {
        report_(Code::limit_memory, {field_.id_in_source, {}}, {memory_text()});
        return std::nullopt;
      }
      std::vector<std::int64_t> numbers(most / sizeof(std::int64_t) + 1);
      const auto size = decode(*embedded, reinterpret_cast<std::byte*>(numbers.data()));
      if (!size) return std::nullopt;
      numbers.resize(*size / sizeof(std::int64_t));
      return numbers;
    }
    const auto& external = std::get<ExternalValues>(mesh.connectivity);
    if (!has_points(external.format))
      return read_with<std::vector<std::int64_t>>(external, read_field_integers, corners,
                                                  static_cast<std::size_t>(mesh.elements));
    auto table = read_with<fields::Table>(external, read_field_file, 0);
    if (!table) return std::nullopt;
    return std::move(corners == 4 ? table->tetra : table->hexa);
  }

  const EvaluationData& data_;
  const VectorField& field_;
  const Report& report_;
  std::shared_ptr<FieldSource> source_;
};

bool FieldLoader::prepare(FieldSource& source) {
  std::vector<Vec3> points;
  const bool needs_points = !source.grid_ || field_.interpolation->method != InterpolationMethod::linear;
  if (needs_points) {
    // What the numbers themselves may take is left (number_block.hpp).
    const std::uint64_t needed = source.records() * bytes_per_place, budget = data_.run.max_memory_bytes;
    if (needed > budget - budget / fields::numbers_part)
      return fault(Code::limit_memory, {field_.id_in_source, {}}, {memory_text()});
    points.reserve(source.records());
    for (std::size_t r = 0; r < source.records(); ++r) {
      if (is_stopped(r)) return stopped();
      points.push_back(source.place(r));
    }
  }
  const auto* mesh = std::get_if<MeshLocation>(&structure().location);
  if (mesh != nullptr && field_.interpolation->method == InterpolationMethod::linear) {
    const std::size_t corners = mesh->type == MeshElementType::tetra ? 4 : 8;
    auto numbers = connectivity(*mesh, corners);
    if (!numbers) return false;
    const Place place{mesh->id_in_source, "elements"};
    if (numbers->size() != corners * static_cast<std::size_t>(mesh->elements))
      return fault(Code::field_elements, place,
                   {field_.id.text, "has " + std::to_string(numbers->size() / corners) + " elements of this type, " +
                                        std::to_string(mesh->elements) + " are stated"});
    const auto records = static_cast<std::int64_t>(source.records());
    const auto wrong =
        std::find_if(numbers->begin(), numbers->end(), [&](std::int64_t n) { return n < 0 || n >= records; });
    if (wrong != numbers->end())
      return fault(Code::field_elements, place,
                   {field_.id.text, "names record " + std::to_string(*wrong) + " of " + std::to_string(records)});
    source.mesh_ = fields::MeshInterpolation::make(std::make_shared<const std::vector<Vec3>>(points), corners,
                                                   std::move(*numbers), data_.run);
    if (!source.mesh_) return stopped();
  }
  if (needs_points) source.search_ = fields::PointSearch::make(std::move(points), data_.run);
  return !needs_points || source.search_ || stopped();
}

std::shared_ptr<FieldSource> FieldSource::load(const EvaluationData& data, const VectorField& field,
                                               const Report& report) {
  return FieldLoader(data, field, report).load();
}

bool FieldSource::prepare_sampling(const EvaluationData& data, const Report& report) {
  if (!is_ready_ && !wall_) is_ready_ = FieldLoader(data, *field_, report).prepare(*this);
  return is_ready_ || wall_;
}

}  // namespace meso::eval
