// SPDX-License-Identifier: Apache-2.0
#pragma once
// Beams as the primitives they are the union of. Private.

#include <optional>

#include "meso/eval/shape.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Balls, cylinders, cones and half-balls of all nodes, struts and caps, equal ones once; sizes checked
/// (GEOMETRY_SIZE). They overlap: their union is the body. May throw Standard_Failure.
[[nodiscard]] std::optional<Solids> beam_primitives(const eval::BeamsShape& beams, const Affine& map, ElementId where,
                                                    const SolidContext& context);

/// For people: "the length of the beam at (1 2 3) mm", where it begins.
[[nodiscard]] std::string size_of_beam_at(const char* what, Vec3 from);

}  // namespace meso::brep
