// SPDX-License-Identifier: Apache-2.0
#pragma once
// What expressions can ask of a vector field: its components, and what follows from them.
//
//   for (const FieldQuantity& q : field_quantities(field)) names.push_back(field.id.text + "." + q.name);
//
// Components come first, in their order. A component that has the name of a derived quantity takes its place.

#include <string>
#include <vector>

#include "meso/model/field.hpp"

namespace meso {

struct FieldQuantity {
  enum class Kind {
    component,  ///< number `which`; of a macrostructure: distance, nx, ny, nz, curvature
    magnitude,  ///< of the vector
    principal,  ///< value number `which` of the tensor, 0 the largest
    direction,  ///< `axis` of the direction that belongs to value number `which`
    von_mises,
    gradient,  ///< of component `which`, along the global `axis`
  };
  std::string name;
  Kind kind = Kind::component;
  std::size_t which = 0, axis = 0;
};

[[nodiscard]] std::vector<FieldQuantity> field_quantities(const VectorField& field);

}  // namespace meso
