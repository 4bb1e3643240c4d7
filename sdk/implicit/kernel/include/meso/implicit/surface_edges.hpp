// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether the surface of a field may have edges and corners in a box, by the operations that the field is made of.
//
//   may_have_edges(sin(x) * cos(y) + z, box) == false
//   may_have_edges(max(ball, gyroid), box) == true       // where the two meet
//   may_have_edges(abs(gyroid) - 0.3, box) == false      // abs() turns where the field is -0.3
//
// "No" is certain, but for poles and cusps of smooth functions; "yes" is not: of minima and maxima that both sides may
// win, distances to meshes and functions that are computed point by point, nothing more is known. Time linear in the
// number of operations.

#include "meso/base/vec.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

[[nodiscard]] bool may_have_edges(const Term& term, const Box3& box);

}  // namespace meso::implicit
