// SPDX-License-Identifier: Apache-2.0
#pragma once
// A Shape, whose numbers are known, as OpenCASCADE solids. Private.
//
//   if (const auto solids = solid_from_shape(shape, world_from_cell, context)) ...
//
// Millimetres. Primitives are checked before OpenCASCADE sees them, booleans after (boolean.hpp), imports on reading.
// Parts are asked of the context. Implicit bodies are BREP_NOT_REALISED. OpenCASCADE's failures come back as
// GEOMETRY_KERNEL.

#include <optional>

#include "meso/eval/shape.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// The regularised set under an affine map; empty solids mean an empty set.
[[nodiscard]] std::optional<Solids> solid_from_shape(const eval::Shape& shape, const Affine& map,
                                                     const SolidContext& context);

}  // namespace meso::brep
