// SPDX-License-Identifier: Apache-2.0
#include "meso/model/field_quantities.hpp"

#include <algorithm>

namespace meso {
namespace {

using Kind = FieldQuantity::Kind;
constexpr char axis_letters[] = {'x', 'y', 'z'};

class QuantityList {
 public:
  void add(std::string name, Kind kind, std::size_t which = 0, std::size_t axis = 0) {
    const bool is_taken =
        std::any_of(quantities.begin(), quantities.end(), [&](const FieldQuantity& q) { return q.name == name; });
    if (kind == Kind::component || !is_taken) quantities.push_back({std::move(name), kind, which, axis});
  }
  std::vector<FieldQuantity> quantities;
};

void add_derived(QuantityList& list, const FieldStructure& structure) {
  const auto count = [&](ComponentRole role) {
    return std::count_if(structure.components.begin(), structure.components.end(),
                         [&](const FieldComponent& c) { return c.role == role; });
  };
  if (count(ComponentRole::vector) > 0) list.add("magnitude", Kind::magnitude);
  if (count(ComponentRole::tensor) == 6) {
    for (std::size_t i = 0; i < 3; ++i) list.add("principal" + std::to_string(i + 1), Kind::principal, i);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t a = 0; a < 3; ++a)
        list.add("dir" + std::to_string(i + 1) + axis_letters[a], Kind::direction, i, a);
    }
    list.add("vonMises", Kind::von_mises);
  }
  if (!std::holds_alternative<RegularGridLocation>(structure.location) &&
      !std::holds_alternative<RectilinearGridLocation>(structure.location))
    return;
  for (std::size_t c = 0; c < structure.components.size(); ++c) {
    for (std::size_t a = 0; a < 3; ++a)
      list.add(structure.components[c].name.text + "_d" + axis_letters[a], Kind::gradient, c, a);
  }
}

}  // namespace

std::vector<FieldQuantity> field_quantities(const VectorField& field) {
  QuantityList list;
  if (field.macrostructure) {
    static constexpr const char* names[] = {"distance", "nx", "ny", "nz", "curvature"};
    for (std::size_t i = 0; i < 5; ++i) list.add(names[i], Kind::component, i);
  } else if (field.structure) {
    for (std::size_t i = 0; i < field.structure->components.size(); ++i)
      list.add(field.structure->components[i].name.text, Kind::component, i);
    add_derived(list, *field.structure);
  }
  return std::move(list.quantities);
}

}  // namespace meso
