// SPDX-License-Identifier: Apache-2.0
#pragma once
// Beam primitives as exact signed distances: the yardstick that does not come from the boolean it checks.

#include <span>

#include "meso/base/vec.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

/// Exact, negative inside.
[[nodiscard]] double signed_distance(const CellPrimitive& primitive, Vec3 p);
/// Of the union; exact outside, a bound inside.
[[nodiscard]] double signed_distance(std::span<const CellPrimitive> primitives, Vec3 p);

[[nodiscard]] Box3 bounds(const CellPrimitive& primitive);
[[nodiscard]] CellPrimitive translated(const CellPrimitive& primitive, Vec3 by);

/// The same body, whichever end of a strut is named first.
[[nodiscard]] bool same(const CellPrimitive& a, const CellPrimitive& b, double tolerance);

/// Whether `primitive`, where it is inside `box`, adds nothing to the union of `others`. Proven by subdivision; what
/// protrudes by less than 1e-4 of the box is not seen, and a proof that grows too long answers no.
[[nodiscard]] bool covered(const CellPrimitive& primitive, std::span<const CellPrimitive> others, const Box3& box);

/// Volume of the union inside the box by sampling: good to a few parts in a thousand, or, at a fiftieth of the cost and
/// depth 5, in a hundred.
[[nodiscard]] double sampled_volume(std::span<const CellPrimitive> primitives, const Box3& box, int depth = 7);

}  // namespace meso::brep
