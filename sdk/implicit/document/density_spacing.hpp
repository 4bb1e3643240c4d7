// SPDX-License-Identifier: Apache-2.0
#pragma once
// How fine samples must be for a cell to hold the share of its box that is stated. Private.

#include "meso/base/vec.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

/// The relative error of the volume that spacing_for_share() leaves.
inline constexpr double density_error = 0.002;

/// Of a body that repeats with the box and fills `share` of it: how far apart samples may be, in edges of the box. The
/// error of a mesh goes with the square of that; it is measured on 64 samples along each edge. Infinity if that is not
/// known.
[[nodiscard]] double spacing_for_share(const Term& body, const Box3& box, double share);

}  // namespace meso::implicit
