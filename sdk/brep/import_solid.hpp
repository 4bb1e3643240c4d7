// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bodies in foreign files as solids: STEP and IGES with their own unit, BREP, STL as flat facets. Private.
//
// A stated SHA-256 must match (IMPORT_CHANGED). The file must hold at least one solid, and each must be closed with a
// positive volume (IMPORT_NOT_CLOSED); nothing is healed. STEP costs about 1 ms a face, growing faster than the number
// of faces. OpenCASCADE hangs on NaN in STEP and overruns its stack where entities refer to each other in a
// circle: such files are refused before it sees them.

#include <optional>

#include "meso/eval/shape.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Files for audits and pictures may cross themselves; in a part they may not (IMPORT_OVERLAPS).
enum class Crossing { refused, read };

[[nodiscard]] std::optional<Solids> import_solids(const eval::ImportShape& import, const Affine& map, ElementId where,
                                                  const SolidContext& context, Crossing crossing = Crossing::refused);

}  // namespace meso::brep
