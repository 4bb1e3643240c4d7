// SPDX-License-Identifier: Apache-2.0
// a unit cell that names one of the library becomes that cell, with the values it gives to its parameters.
#include <algorithm>

#include "families.hpp"
#include "meso/library/library.hpp"
#include "meso/model/describe.hpp"

namespace meso {
namespace {

/// Gives every element below one the place of an element of the document.
class Moved {
 public:
  explicit Moved(ElementId place) : place_(place) {}

  template <class T>
  void attribute(std::string_view, T&) {}
  void text(std::string&) {}
  template <class E>
  void child(std::string_view, std::optional<E>& e) {
    if (e) move(*e);
  }
  template <class E>
  void child(std::string_view, E& e) {
    move(e);
  }
  template <class E>
  void children(std::string_view, std::vector<E>& all) {
    for (E& e : all) move(e);
  }
  template <class E>
  void sequence(std::vector<E>& all) {
    for (E& e : all) choice(e);
  }
  template <class... Es>
  void choice(std::variant<Es...>& alternatives) {
    std::visit([this](auto& e) { move(e); }, alternatives);
  }
  void choice(CsgNode& node) { choice(node.value); }

  void move(std::monostate) {}
  template <class E>
  requires std::is_base_of_v<Element, E>
  void move(E& e) {
    e.id_in_source = place_;
    describe(*this, e);
  }

 private:
  ElementId place_;
};

std::vector<std::string_view> names_of(const std::vector<CellParameter>& parameters) {
  std::vector<std::string_view> names;
  for (const CellParameter& p : parameters) names.push_back(p.name.text);
  return names;
}

/// The library's parameters in their order, those that the document names with its values.
std::vector<CellParameter> joined(Context& c, const UnitCell& cell, const UnitCell& named) {
  std::vector<CellParameter> all = named.parameters;
  for (CellParameter& p : all) p.id_in_source = cell.id_in_source;
  std::vector<bool> given(all.size(), false);
  for (const CellParameter& own : cell.parameters) {
    const auto found = std::ranges::find(all, own.name.text, [](const CellParameter& p) { return p.name.text; });
    if (found == all.end()) {
      c.report(Code::link_unknown_parameter, own, "id",
               {cell.library->text, own.name.text,
                c.suggestion_or_list(own.name.text, names_of(named.parameters), "parameters")});
      continue;
    }
    const auto index = static_cast<std::size_t>(found - all.begin());
    if (given[index])
      c.report(Code::name_duplicate, own, "id",
               {own.name.text, "a parameter of the unit cell '" + cell.id.text + "'", "another one"});
    given[index] = true;
    CellParameter value = own;
    if (!value.min) value.min = found->min;
    if (!value.max) value.max = found->max;
    *found = std::move(value);
  }
  return all;
}

}  // namespace

void fill_library_cells(Context& c, Document& document) {
  for (UnitCell& cell : document.unit_cells.items) {
    if (!cell.library) continue;
    const UnitCell* named = find_library_cell(cell.library->text);
    if (named == nullptr) {
      c.report(Code::link_unknown_library_cell, cell, "library",
               {cell.library->text, c.suggestion(cell.library->text, library_cell_names())});
      c.forget(cell);
      continue;
    }
    if (cell.box || cell.clip_to_box || !std::holds_alternative<std::monostate>(cell.body)) {
      c.report(Code::library_cell_complete, cell, "library", {cell.id.text});
      continue;
    }
    UnitCell filled = *named;
    Moved(cell.id_in_source).move(filled);
    filled.parameters = joined(c, cell, *named);
    cell.parameters = std::move(filled.parameters);
    cell.box = std::move(filled.box);
    cell.clip_to_box = filled.clip_to_box;
    cell.body = std::move(filled.body);
  }
}

}  // namespace meso
