// SPDX-License-Identifier: Apache-2.0
// a length is not added to an angle, and does not stand where an angle is asked for. Only
// written units speak; what they are written in carries them: parameters, and what is set.
#include <algorithm>
#include <map>
#include <string>

#include "attribute_dimensions.hpp"
#include "families.hpp"
#include "meso/expr/dimension.hpp"
#include "meso/expr/expression.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

using expr::Dimension;

/// What is asked for, and how it is written.
std::string wish(Dimension dimension) {
  const std::string what(expr::to_text(dimension));
  if (dimension == Dimension::length) return what + "; write mm, cm, m, um, in or ft";
  if (dimension == Dimension::angle) return what + "; write deg or rad";
  return what + "; write it without a unit";
}

/// What names are, in layers: the document's parameters, the cell's, the pattern's indices. All others are open.
struct Dimensions {
  const Dimensions* outer = nullptr;  ///< outlives this one
  std::map<std::string, Dimension, std::less<>> own{};

  [[nodiscard]] Dimension at(std::string_view name) const {
    const auto found = own.find(name);
    if (found != own.end()) return found->second;
    return outer != nullptr ? outer->at(name) : Dimension::open;
  }
};

std::vector<Dimension> of_names(const expr::Expression& expression, const Dimensions& known) {
  std::vector<Dimension> all;
  for (const expr::Name& name : expression.names()) all.push_back(known.at(name.text));
  return all;
}

/// Open where anything is wrong: it is told elsewhere.
Dimension dimension_of(const Context& c, std::string_view text, const Dimensions& names) {
  const expr::ParseResult parsed = expr::parse_expression(text, c.document.unit);
  return parsed.expression ? expr::dimension_of(*parsed.expression, of_names(*parsed.expression, names)).dimension
                           : Dimension::open;
}

/// What ought to stand somewhere, and what the message says of the place: "wall" is "a length".
struct Wanted {
  Dimension dimension = Dimension::open;
  Code code = Code::value_unit;
  std::string what{};

  [[nodiscard]] bool refuses(Dimension found) const {
    if (dimension == Dimension::number) return found >= Dimension::length;
    return !expr::fits(dimension, found);
  }
};

/// As the value of a parameter is, if a unit says so.
Wanted like(Dimension value, std::string_view parameter) {
  if (value < Dimension::length) return {};
  return {.dimension = value, .what = "the parameter '" + std::string(parameter) + "'"};
}

/// Null: along a direction.
Wanted along(const Axis* axis) {
  if (axis == nullptr) return {.dimension = Dimension::length, .code = Code::axis_unit, .what = "a direction"};
  if (axis->kind == AxisKind::scalar) return {};
  return {.dimension = axis->kind == AxisKind::circular ? Dimension::angle : Dimension::length,
          .code = Code::axis_unit,
          .what = "the axis '" + axis->name.text + "'"};
}

/// A visitor for walk(): every expression of an element and of those below it. `Tell` gets each fault.
template <class Tell>
class DimensionWalk {
 public:
  DimensionWalk(const Context& c, const Dimensions& names, Tell tell) : c_(c), names_(names), tell_(tell) {}

  /// Of a pattern or a grid, null for a broken link; a volume element brings its own.
  void set_axes(const std::vector<Axis>* axes) { axes_ = axes; }
  void set_cell_parameters(const Dimensions* parameters) { parameters_ = parameters; }

  template <class E, class T>
  void operator()(const E&, std::string_view, const T&) {}
  void operator()(const VolumeElementPrimitive&, std::string_view, const Ref<CoordinateSystem>& system) {
    axes_ = axes_of(c_, system);
  }
  template <class E>
  void operator()(const E& owner, std::string_view attribute, const Expression& value) {
    if (attribute == "nodeRadius" && value.text == "auto") return;
    (void)check(owner, attribute, value.text, 0, wanted(owner, attribute));
  }
  template <class E>
  void operator()(const E& owner, std::string_view attribute, const ExpressionList& list) {
    const std::vector<expr::ListItem> items = expr::split_list(list.text);
    for (std::size_t i = 0; i < items.size(); ++i)
      (void)check(owner, attribute, items[i].text, items[i].offset, wanted_item(owner, attribute, i));
  }

  Dimension check(const Element& owner, std::string_view attribute, std::string_view text, std::size_t offset,
                  const Wanted& wanted);

 private:
  [[nodiscard]] const Axis* axis(const Name& name) const {
    if (axes_ == nullptr) return nullptr;
    const auto found = std::ranges::find(*axes_, name, &Axis::name);
    return found == axes_->end() ? nullptr : &*found;
  }
  /// Nothing is wanted along an axis that is not known.
  [[nodiscard]] Wanted along_known(const Name& name) const {
    const Axis* found = axis(name);
    return found == nullptr ? Wanted{} : along(found);
  }

  template <class E>
  [[nodiscard]] Wanted wanted(const E& owner, std::string_view attribute) const {
    if constexpr (std::same_as<E, Loop>) {
      if (attribute == "start" || attribute == "spacing" || attribute == "position" || attribute == "size")
        return owner.axis ? along_known(*owner.axis) : along(nullptr);
    } else if constexpr (AnyOf<E, AxisRange, FillRange>) {
      return along_known(owner.axis);
    } else if constexpr (AnyOf<E, GridAxis, RectilinearAxis>) {
      return along_known(owner.name);
    } else if constexpr (std::same_as<E, SetInstruction>) {
      if (attribute == "value" && parameters_ != nullptr)
        return like(parameters_->at(owner.parameter.text), owner.parameter.text);
    }
    return {.dimension = attribute_dimension<E>(attribute), .what = std::string(attribute)};
  }

  template <class E>
  [[nodiscard]] Wanted wanted_item(const E& owner, std::string_view attribute, std::size_t i) const {
    if constexpr (std::same_as<E, ListPlace>) {
      return axes_ == nullptr || i >= axes_->size() ? Wanted{} : along(&(*axes_)[i]);
    } else {
      if (attribute == "matrix")
        return i % 4 == 3 ? Wanted{.dimension = Dimension::length, .what = "the offset of a matrix"} : Wanted{};
      return wanted(owner, attribute);
    }
  }

  const Context& c_;
  const Dimensions& names_;
  Tell tell_;
  const std::vector<Axis>* axes_ = nullptr;
  const Dimensions* parameters_ = nullptr;
};

template <class Tell>
Dimension DimensionWalk<Tell>::check(const Element& owner, std::string_view attribute, std::string_view text,
                                     std::size_t offset, const Wanted& wanted) {
  const expr::ParseResult parsed = expr::parse_expression(text, c_.document.unit);
  if (!parsed.expression) return Dimension::open;
  const auto [found, clash] = expr::dimension_of(*parsed.expression, of_names(*parsed.expression, names_));
  if (clash) {
    tell_(Code::expression_units, owner, attribute,
          std::vector<std::string>{std::string(clash->first), std::string(expr::to_text(clash->first_is)),
                                   std::string(clash->second), std::string(expr::to_text(clash->second_is()))},
          offset + clash->offset, std::size_t{clash->length});
    return Dimension::open;
  }
  if (!wanted.refuses(found)) return found;
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const std::string_view whole = text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
  const std::string asked = wanted.code != Code::axis_unit         ? wish(wanted.dimension)
                            : wanted.dimension == Dimension::angle ? "angles"
                                                                   : "lengths";
  tell_(wanted.code, owner, attribute,
        std::vector<std::string>{std::string(whole), std::string(expr::to_text(found)), wanted.what, asked},
        offset + begin, whole.size());
  return Dimension::open;
}

class DimensionCheck {
 public:
  explicit DimensionCheck(Context& c) : c_(c) {}

  void run() {
    for (const Parameter& p : c_.document.parameters) visit_parameter(p);
    for (const CoordinateSystem& system : c_.document.coordinate_systems) visit(system);
    for (const Macrostructure& m : c_.document.macrostructures) visit(m);
    for (const VectorField& field : c_.document.vector_fields) visit_field(field);
    for (const UnitCell& cell : c_.document.unit_cells) find_parameters(cell);
    for (const Pattern& pattern : c_.document.patterns) find_set_parameters(pattern);
    for (const UnitCell& cell : c_.document.unit_cells) visit_cell(cell);
    for (const Pattern& pattern : c_.document.patterns) visit_pattern(pattern);
    for (const Part& part : c_.document.parts) visit(part);
    for (const BuildItem& item : c_.document.build) visit(item);
  }

 private:
  auto walker(const Dimensions& names) {
    const auto report = [this](Code code, const Element& owner, std::string_view attribute,
                               std::vector<std::string> args, std::size_t offset, std::size_t length) {
      c_.report(code, owner, attribute, std::move(args), offset, length);
      has_fault_ = true;
    };
    return DimensionWalk(c_, names, report);
  }
  /// A parameter at fault has no value, nor has what is computed from it: no consequence of the fault is told.
  void visit_parameter(const Parameter& p) {
    has_fault_ = false;
    names_.own[p.id.text] = parameter(p, p.id.text, names_);
    if (has_fault_ || !c_.constant(p.value)) c_.values.erase(p.id.text);
  }
  template <class E>
  void visit(const E& element) {
    walk(element, walker(names_));
  }

  /// The value, and min and max, which are compared with it.
  template <class P>
  Dimension parameter(const P& p, const std::string& name, const Dimensions& names) {
    auto check = walker(names);
    const Dimension found = check.check(p, "value", p.value.text, 0, {});
    if (p.min) (void)check.check(p, "min", p.min->text, 0, like(found, name));
    if (p.max) (void)check.check(p, "max", p.max->text, 0, like(found, name));
    return found;
  }

  void visit_field(const VectorField& field) {
    auto check = walker(names_);
    if (field.structure)
      std::visit(
          [&](const auto& location) {
            if constexpr (requires { location.axes; }) check.set_axes(axes_of(c_, location.coordinate_system));
          },
          field.structure->location);
    walk(field, check);
  }

  /// What the parameters of a cell are by their defaults.
  void find_parameters(const UnitCell& cell) {
    Dimensions& names = cells_[&cell];
    names.outer = &names_;
    for (const CellParameter& p : cell.parameters) names.own[p.name.text] = dimension_of(c_, p.value.text, names);
  }
  /// What a default without unit leaves open, the first value with a unit says.
  void find_set_parameters(const Pattern& pattern) {
    const UnitCell* cell = c_.find(pattern.unit_cell);
    if (cell == nullptr) return;
    for (const Instruction& instruction : pattern.instructions) {
      const auto* set = std::get_if<SetInstruction>(&instruction);
      if (set == nullptr) continue;
      auto& parameters = cells_[cell].own;
      const auto found = parameters.find(set->parameter.text);
      if (found != parameters.end() && found->second == Dimension::open)
        found->second = dimension_of(c_, set->value.text, names_of(pattern, cell));
    }
  }
  Dimensions names_of(const Pattern& pattern, const UnitCell* cell) {
    Dimensions names{.outer = cell != nullptr ? &cells_[cell] : &names_};
    for (const Loop& loop : pattern.loops) names.own[loop.index.text] = Dimension::number;
    return names;
  }

  void visit_cell(const UnitCell& cell) {
    if (cell.library) return visit_library_cell(cell);
    Dimensions before{.outer = &names_};
    for (const CellParameter& p : cell.parameters) before.own[p.name.text] = parameter(p, p.name.text, before);
    const Dimensions& names = cells_[&cell];
    if (cell.box) walk(*cell.box, walker(names));
    std::visit(
        [&](const auto& body) {
          if constexpr (!std::same_as<std::decay_t<decltype(body)>, std::monostate>) walk(body, walker(names));
        },
        cell.body);
  }

  /// The body is not the document's: a fault there is one of the value that the document gives.
  void visit_library_cell(const UnitCell& cell) {
    for (const CellParameter& p : cell.parameters) {
      if (p.id_in_source.value == cell.id_in_source.value) continue;  // as the library has it
      const Dimension found = parameter(p, p.name.text, names_);
      if (found < Dimension::length) continue;
      const Dimensions alone{.own = {{p.name.text, found}}};
      bool suits = true;
      const auto note = [&](auto&&...) { suits = false; };
      const DimensionWalk check(c_, alone, note);
      if (cell.box) walk(*cell.box, DimensionWalk(check));
      if (const auto* beams = std::get_if<BeamsBody>(&cell.body)) walk(*beams, DimensionWalk(check));
      if (suits) continue;
      const Dimension other = found == Dimension::angle ? Dimension::length : Dimension::angle;
      c_.report(Code::value_unit, p, "value",
                {p.value.text, std::string(expr::to_text(found)), "the parameter '" + p.name.text + "'", wish(other)});
    }
  }

  void visit_pattern(const Pattern& pattern) {
    const UnitCell* cell = c_.find(pattern.unit_cell);
    const Dimensions names = names_of(pattern, cell);
    auto check = walker(names);
    check.set_axes(axes_of(c_, pattern.coordinate_system));
    if (cell != nullptr) check.set_cell_parameters(&cells_[cell]);
    walk(pattern, check);
  }

  Context& c_;
  Dimensions names_;
  std::map<const UnitCell*, Dimensions> cells_;
  bool has_fault_ = false;
};

}  // namespace

void check_dimensions(Context& c) { DimensionCheck(c).run(); }

}  // namespace meso
