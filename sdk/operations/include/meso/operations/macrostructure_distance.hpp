// SPDX-License-Identifier: Apache-2.0
#pragma once
// Fields of macrostructures, answered by the distance to triangles of the exact body.
//
//   eval::Evaluation::make(checked, {.distance = operations::macrostructure_distance({}, run)}, sink);
//
// Exact to rounding for bodies with plane faces, else to a ten-thousandth of the body's size. The normal is that of the
// nearest point, where there are several of one of them. The mean curvature is not answered. In a build without the
// implicit engine the function is empty: such fields are not realised.

#include <vector>

#include "meso/eval/evaluation.hpp"

namespace meso::operations {

[[nodiscard]] eval::FindMacrostructureDistance macrostructure_distance(std::vector<eval::Override> overrides,
                                                                       RunOptions run);

}  // namespace meso::operations
